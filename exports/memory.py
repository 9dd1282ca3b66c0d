class Memory:
    """What a body remembers whose stress relaxes, at the start of each explicit step of the length h, s; with h = None all that relaxes has relaxed.

    Where shear alone relaxes, the body is an exact network of tetrahedra and each term a branch of springs of rest length zero, along `edges`, whose
    constants S relax towards those of the present shape. With e = exp(-h/tau) and gamma = (1 - e) tau/h, a step has the forces of S and of
    a content with the factor gamma, and then S <- e S + gamma (1 - e) J^(2/3) k(x). Where shear and bulk relax alike, each spring has a dashpot in
    series for each term, which has lengthened by w, and the spring acts as if its rest measure were longer by the sum of g w.
    Theory: page "Springs that forget" of the book of springfit.
    """

    def __init__(self, net, h):
        start = net["points"]
        self.springs, self.volumes = net["springs"], net["volumes"]
        self.k, self.k_volume, self.rest_volume = net["k"], net["k_volume"], net["rest_volume"]
        self.shares, times = net["relaxation_shear"], net["relaxation_time"]
        self.has_branches = not np.any(net["relaxation_bulk"])
        self.edges, self.is_relaxed = np.empty((0, 2), int), h is None
        left = 1 - self.shares.sum()
        if self.is_relaxed and not left > 1e-9:
            sys.exit("all stress of the body relaxes, so that it does not come to rest")
        if not self.is_relaxed:
            self.decay = np.exp(-h / times)
            self.mean = -np.expm1(-h / times) * times / h
        if self.has_branches:
            self.v0 = self.shape(start)[1]
            # A spring on a content at rest has k (rest - V) = mu and k V = lambda + mu. What is left of mu is beside the same bulk modulus.
            self.mu = self.k_volume * (self.rest_volume - self.v0)
            bulk = self.k_volume * self.v0 - self.mu / 3
            self.k, self.k_volume = left * self.k, (bulk + left * self.mu / 3) / self.v0
            self.rest_volume = self.v0 + left * self.mu / self.k_volume
            pairs = np.sort(self.volumes[:, [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]], axis=2).reshape(-1, 2)
            self.edges, self.edge_of = np.unique(pairs, axis=0, return_inverse=True)
            if not self.is_relaxed:
                self.state = np.outer(self.shares * self.mean, self.constants(*self.shape(start)))
        elif self.is_relaxed:
            self.k, self.k_volume = left * self.k, left * self.k_volume
        else:
            self.start = self.measures(start)
            self.last, self.creep = np.zeros_like(self.start), np.zeros((len(times), len(self.start)))

    def shape(self, x):
        """The gradients of the shape functions of the tetrahedra at x, [cells, 4, 3], and their volumes."""
        e = x[self.volumes[:, 1:]] - x[self.volumes[:, :1]]
        n = np.cross(np.roll(e, -1, 1), np.roll(e, -2, 1))
        v = np.einsum("ck,ck->c", e[:, 0], n[:, 0]) / 6
        n = n / (6 * v)[:, None, None]
        return np.concatenate([-n.sum(1, keepdims=True), n], axis=1), v

    def constants(self, n, v):
        """The constants along the edges of springs that have relaxed to this shape."""
        of_pairs = -np.einsum("cak,cbk->cab", n, n)[:, [0, 0, 0, 1, 1, 2], [1, 2, 3, 2, 3, 3]]
        own = (self.mu * self.v0 * (v / self.v0) ** (2 / 3))[:, None] * of_pairs
        return np.bincount(self.edge_of.ravel(), own.ravel(), len(self.edges))

    def measures(self, x):
        """The lengths of the springs and the volumes."""
        e = x[self.volumes[:, 1:]] - x[self.volumes[:, :1]] if len(self.volumes) else np.empty((0, 3, 3))
        return np.concatenate([np.linalg.norm(x[self.springs[:, 1]] - x[self.springs[:, 0]], axis=1), np.linalg.det(e) / 6])

    def step(self, x):
        """At the end of a step, at x: by how much the rest lengths and rest volumes are longer, and the constants of the springs along `edges`. The
        next call is that of the next step."""
        count = len(self.springs)
        if self.is_relaxed:
            return np.zeros(count), np.zeros(len(self.volumes)), np.zeros(len(self.edges))
        if self.has_branches:
            n, v = self.shape(x)
            push = self.shares @ self.mean * self.mu * self.v0 * (v / self.v0) ** (2 / 3) / v
            now = self.state.sum(axis=0)
            self.state = self.decay[:, None] * self.state + np.outer(self.shares * self.mean * (1 - self.decay), self.constants(n, v))
            return np.zeros(count), push / self.k_volume, now
        c = self.measures(x) - self.start
        decay = self.decay[:, None]
        self.creep = decay * self.creep + (1 - decay) * self.last + np.outer(1 - self.mean, c - self.last)
        self.last = c
        longer = self.shares @ self.creep
        return longer[:count], longer[count:], np.empty(0)
