#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""An elastic plate that floats on waves, by linear theory (Meylan and Squire 1994), in two
dimensions, in water of finite depth and with a draft: how it bends, what it reflects, what passes.

  cases/reference/floating_plate.py    a table of reflection and transmission over stiffness

Everything is a factor of exp(-i omega t), for waves of unit amplitude that run towards larger x.
The potential phi at the surface of the water follows from Green's identity over straight panels,
with images in the bed. On the open surface phi_n = (omega^2/g) phi; on the hull it is the velocity
of the plate; at both ends of the water waves leave. The plate is a line at the depth of the draft,
with upright edges. It moves along x as a whole and across as a sum of Legendre polynomials, whose
energy of bending makes moment and shear force vanish at its ends. Left out are what the weight and
the pressure at rest change in the stiffness, of the order of (k draft)^2."""
import numpy as np
from numpy.polynomial import legendre

RHO, G = 1000.0, 9.81


def wave_number(omega, depth):
    """k of omega^2 = g k tanh(k d)."""
    alpha = omega**2 / G
    low, high = alpha, alpha + 1 / depth + np.sqrt(alpha / depth)
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if middle * np.tanh(middle * depth) > alpha else (middle, high)
    return low


def potentials(at, a, b):
    """Integrals of ln r and of its derivative along the outer normal over the panels from a to b,
    which have the water on their left, seen from the points `at`."""
    length = abs(b - a)
    place = (at[:, None] - a) * np.conj(b - a) / length
    x, y = place.real, place.imag
    seen = np.arctan2(length * abs(y), x * (x - length) + y**2)
    value = x * np.log(abs(place)) - (x - length) * np.log(abs(place - length)) - length
    return value + abs(y) * seen, np.where(abs(y) < 1e-12, 0, np.sign(y) * seen)


class Plate:
    """Its response. x begins at its end. `edge` is the height of its edges above the plate, `pull`
    the stiffness of a spring along x. Complex: `reflected`, `transmitted`, `parts` of the Legendre
    polynomials and then of the motion along x."""

    def __init__(self, omega, depth, length, stiffness, mass, draft=0.0, edge=0.0, pull=0.0,
                 panels=240, modes=14, away=2.0):
        k = wave_number(omega, depth)
        self.length, self.depth, self.number = length, depth, k
        far, size = away * depth, length / panels
        corners = np.array([-far - 1j * depth, -far, 0, -1j * draft, length - 1j * draft, length,
                            length + far, length + far - 1j * depth])[::-1]
        counts = [max(1, round(abs(q - p) / size)) if q != p else 0
                  for p, q in zip(corners, corners[1:])]
        ends = np.concatenate([*(p + (q - p) * np.arange(n) / max(n, 1)
                                 for p, q, n in zip(corners, corners[1:], counts)), corners[-1:]])
        right, open_right, wall_right, bottom, wall_left, open_left, left = (
            np.arange(sum(counts[:j]), sum(counts[:j + 1])) for j in range(7))
        a, b = ends[:-1], ends[1:]
        z, ds = (a + b) / 2, abs(b - a)
        single, double = (np.array(potentials(z, a, b))
                          + potentials(z, np.conj(b) - 2j * depth, np.conj(a) - 2j * depth))
        double -= np.pi * np.eye(len(z))  # double phi = single phi_n

        # Velocity of the hull out of the water by a unit of each mode, over -i omega.
        x = 2 * z[bottom].real / length - 1
        along = np.zeros((len(z), modes + 1))
        along[bottom, :modes] = legendre.legvander(x, modes - 1)
        slope = [2 / length * legendre.legval([-1, 1], legendre.legder(row))
                 for row in np.eye(modes)]
        for wall, sign, end in ((wall_left, 1, 0), (wall_right, -1, 1)):
            height = z[wall].imag + draft
            along[wall, :modes] = -sign * np.outer(height, [row[end] for row in slope])
            along[wall, modes] = sign

        wave = -1j * G / omega * np.cosh(k * (z.imag + depth)) / np.cosh(k * depth) * np.exp(
            1j * k * z.real)
        rate = np.zeros(len(z), complex)  # phi_n/phi
        rate[open_left] = rate[open_right] = omega**2 / G
        rate[left] = rate[right] = 1j * k
        given = -1j * omega * along.astype(complex)
        comes = np.zeros(len(z), complex)
        comes[left] = -2j * k * wave[left]
        phi = np.linalg.solve(double - single * rate,
                              single @ np.column_stack([given, comes]))
        push = 1j * omega * RHO * (along * ds[:, None]).T @ phi

        at, weight = legendre.leggauss(modes)
        bent = np.array([legendre.legval(at, legendre.legder(row, 2)) for row in np.eye(modes)])
        spring, heavy = np.zeros((2, modes + 1, modes + 1))
        spring[:modes, :modes] = stiffness * (bent * weight) @ bent.T * (2 / length)**3
        own = np.diag(length / (2 * np.arange(modes) + 1))
        spring[:modes, :modes] += RHO * G * own
        spring[modes, modes] = pull
        heavy[:modes, :modes] = mass * own
        heavy[modes, modes] = mass * (length + 2 * edge)
        for end in (0, 1):
            value = np.append(legendre.legvander([2.0 * end - 1], modes - 1)[0], 0)
            turn = np.append([row[end] for row in slope], 0)
            moves = np.append(np.zeros(modes), 1)
            heavy += mass * edge * np.outer(value, value)
            heavy += mass * (edge**3 / 3 * np.outer(turn, turn)
                             - edge**2 / 2 * (np.outer(turn, moves) + np.outer(moves, turn)))
        self.parts = np.linalg.solve(spring - omega**2 * heavy - push[:, :-1], push[:, -1])
        phi = phi[:, -1] + phi[:, :-1] @ self.parts
        deep = np.cosh(k * (z.imag + depth)) * ds
        back = deep[left] @ (wave * np.exp(-2j * k * z.real))[left]
        self.reflected = deep[left] @ (phi - wave)[left] / back
        self.transmitted = deep[right] @ phi[right] / (deep[right] @ wave[right])
        self.x = z[bottom].real
        moved = along[bottom, :modes] @ self.parts[:modes]
        self.pressure = 1j * omega / G * phi[bottom] - moved  # over rho g, without that at rest

    def elevation(self, x):
        return legendre.legval(2 * np.asarray(x) / self.length - 1, self.parts[:-1])


def main():
    depth, length = 2.0, 2 * np.pi
    omega = np.sqrt(G * np.tanh(depth))
    print("A plate as long as the wave, k d = 2. EI k^4/(rho g), k draft, reflected, passed, "
          "energy, ends and middle, largest pressure over rho g")
    for draft in (0.0, 0.05, 0.15):
        for stiffness in (0.0001, 0.3, 1, 2, 4, 10, 100):
            p = Plate(omega, depth, length, stiffness * RHO * G, RHO * max(draft, 1e-3), draft)
            shape = abs(p.elevation([0, length / 2, length]))
            print(f"{stiffness:7g} {draft:5g} {abs(p.reflected):.4f} {abs(p.transmitted):.4f} "
                  f"{abs(p.reflected)**2 + abs(p.transmitted)**2:.4f}",
                  *shape.round(3), abs(p.pressure).max().round(3))


if __name__ == "__main__":
    main()
