#!/usr/bin/env python3
"""Derives the table of src/penumbra/math/uplift.cpp: reflectances of red, green and blue, every 10 nm.

Of all R, G, B >= 0 with R + G + B = 1 that look exactly red, green and blue under D65, the smoothest. Needs Debian's
python3-scipy. Prints red and green; blue is what is left of 1.
"""
import numpy as np
from scipy.optimize import linprog, minimize

# CIE 15:2004, D65, every 10 nm from 300.
D65 = [0.0341, 3.2945, 20.236, 37.0535, 39.9488, 44.9117, 46.6383, 52.0891, 49.9755, 54.6482, 82.7549, 91.486, 93.4318,
       86.6823, 104.865, 117.008, 117.812, 114.861, 115.923, 108.811, 109.354, 107.802, 104.790, 107.689, 104.405,
       104.046, 100.000, 96.3342, 95.7880, 88.6856, 90.0062, 89.5991, 87.6987, 83.2886, 83.6992, 80.0268, 80.2146,
       82.2778, 78.2842, 69.7213, 71.6091, 74.3490, 61.6040, 69.8856, 75.0870, 63.5927, 46.4182, 66.8054, 63.3828,
       64.3040, 59.4519, 51.9590, 57.4406, 60.3125]
NM = np.arange(380, 780) + 0.5  # midpoint rule
KNOTS = np.arange(380, 781, 10)


def lobe(mean, below, above):
    return np.exp(-0.5 * ((NM - mean) / np.where(NM < mean, below, above)) ** 2)


def matching():
    """Linear Rec. 709 of D65 light of each wavelength; each band sums to 1. Wyman, Sloan & Shirley 2013."""
    xyz = np.array([1.056 * lobe(599.8, 37.9, 31.0) + 0.362 * lobe(442.0, 16.0, 26.7) - 0.065 * lobe(501.1, 20.4, 26.2),
                    0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1),
                    1.217 * lobe(437.0, 11.8, 36.0) + 0.681 * lobe(459.0, 26.0, 13.8)])
    primaries = np.array([[.64, .33, .03], [.30, .60, .10], [.15, .06, .79]]).T
    white = np.array([.3127, .3290, 1 - .3127 - .3290]) / .3290
    to_rgb = np.linalg.inv(primaries * np.linalg.solve(primaries, white))
    seen = to_rgb @ xyz * np.interp(NM, np.arange(300, 831, 10), D65)
    return seen / seen.sum(axis=1)[:, None]


def hats():
    """Values at NM of functions that are linear between the knots."""
    h = np.zeros((len(NM), len(KNOTS)))
    for i, nm in enumerate(NM):
        cell, part = divmod((nm - KNOTS[0]) / 10, 1)
        h[i, int(cell)], h[i, int(cell) + 1] = 1 - part, part
    return h


def main():
    n = len(KNOTS)
    bend, step = np.diff(np.eye(n), 2, axis=0), np.diff(np.eye(n), 1, axis=0)
    q = bend.T @ bend + 0.1 * step.T @ step

    def roughness(v):
        r, g = v[:n], v[n:]
        b = 1 - r - g
        return 0.5 * (r @ q @ r + g @ q @ g + b @ q @ b), np.concatenate([q @ (r - b), q @ (g - b)])

    look = np.kron(np.eye(2), matching() @ hats())  # red looks (1, 0, 0), green (0, 1, 0); then blue does what it should
    wanted = np.array([1, 0, 0, 0, 1, 0.0])
    room = -np.hstack([np.eye(n), np.eye(n)])  # R + G <= 1
    start = linprog(np.zeros(2 * n), A_ub=-room, b_ub=np.ones(n), A_eq=look, b_eq=wanted, bounds=(0, 1)).x
    found = minimize(roughness, start, jac=True, bounds=[(0, 1)] * (2 * n), method="SLSQP",
                     options={"maxiter": 1000, "ftol": 1e-14},
                     constraints=[{"type": "eq", "fun": lambda v: look @ v - wanted, "jac": lambda v: look},
                                  {"type": "ineq", "fun": lambda v: 1 + room @ v, "jac": lambda v: room}])
    assert found.success and np.abs(look @ found.x - wanted).max() < 1e-9
    for red, green in zip(found.x[:n], found.x[n:]):
        print(f"    {{{abs(red):.6f}, {abs(green):.6f}}},")


if __name__ == "__main__":
    main()
