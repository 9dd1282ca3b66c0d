def settle(advance, energy, damp, periods):
    """Advances until a body is at rest. The first maximum of the kinetic energy is after a quarter of the slowest motion; from then on
    all velocities are multiplied so that this motion hardly swings, for so many quarters as long. The program ends with 1 where the
    kinetic energy is then above a ten-thousandth of that maximum, which is within reach of numbers of 32 bits."""
    highest = quarter = count = moving = 0
    while not quarter or count <= periods * quarter:
        advance()
        moving = energy()
        if not np.isfinite(moving):
            sys.exit("the motion has diverged")
        count += 1
        if not quarter and moving >= highest:
            highest = moving
            continue
        quarter = quarter or max(count, 3)
        damp(np.exp(-np.pi / quarter))
    if moving > 1e-4 * highest:
        sys.exit(f"the body has not come to rest: its kinetic energy is still {moving / highest:.2g} of the highest")


def taken(net, arguments):
    """The forces [points, 3], N, of the load that --load names, and the other arguments."""
    if {"-h", "--help"} & set(arguments):
        print(__doc__)
        sys.exit()
    forces = np.zeros((len(net["points"]), 3))
    if arguments[-1:] == ["--rest"]:
        sys.exit("--rest: expected a file for the positions, found none")
    if "--rest" in arguments and not Path(arguments[arguments.index("--rest") + 1]).resolve().parent.is_dir():
        sys.exit(f"--rest: expected a file in a folder that is there, found {arguments[arguments.index('--rest') + 1]}")
    if "--load" not in arguments:
        return forces, arguments
    place = arguments.index("--load")
    name, names = "".join(arguments[place + 1 : place + 2]), net["load_names"].tolist()
    if name not in names:
        sys.exit(f"--load: expected one of {names}, found {name!r}")
    number = names.index(name)
    if np.any(net["moved_of"] == number):
        sys.exit(f"--load: expected a load of forces, found {name!r}, which moves points: move them in the program")
    own = net["load_of"] == number
    forces[net["load_points"][own]] = net["load_forces"][own]
    return forces, arguments[:place] + arguments[place + 2 :]


def seconds(given, usual):
    """The time of a motion, s."""
    try:
        return float(given[0]) if given else usual
    except ValueError:
        sys.exit(f"expected --rest FILE, --load NAME or the seconds of a motion, found {given[0]!r}: --help has all")


def keep_rest(net, x, file):
    """Writes the positions [points, 3], m, as an array of NumPy, and says where and how far the body has moved."""
    file = Path(file) if file.endswith(".npy") else Path(file + ".npy")
    np.save(file, x)
    moved = np.linalg.norm(x - net["points"], axis=1)
    print(f"{len(x)} points at rest: the largest displacement is {moved.max():.4g} m, at point {moved.argmax()}; written: {file}")


def inverted(net, x):
    """The number of simplices of the mesh that are inside out at the positions x."""
    cells = net["tets"]
    if not len(cells):
        return 0
    d = cells.shape[1] - 1
    content = lambda x: np.linalg.det(x[cells[:, 1:], :d] - x[cells[:, :1], :d])
    return int(np.sum(~(content(np.asarray(x, float)) * content(net["points"]) > 0)))


def judge(net, x):
    """Ends with 1 and says why if the motion has diverged, or cells of the mesh are inside out at the positions x."""
    if not np.all(np.isfinite(x)):
        sys.exit("the motion has diverged")
    if count := inverted(net, x):
        sys.exit(f"{count} of {len(net['tets'])} cells are inside out: the load is beyond what the springs stand")
