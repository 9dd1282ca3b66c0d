def settle(advance, energy, damp, periods):
    """Advances until a body is at rest. The first maximum of the kinetic energy is after a quarter of the slowest motion; from then on
    all velocities are multiplied so that this motion hardly swings, for so many quarters as long."""
    highest = quarter = count = 0
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
