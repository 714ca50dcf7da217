"""Forward and inverse kinematics of chains of hinges, by angles from the pose in which they stand.

Forward kinematics is a product of exponentials about that pose. Each joint has a frame whose z axis
is its own, so that its exponential turns two coordinates. The inverse begins with cubic polynomials
that fit it nearby, and goes on by least squares that are damped by the square of the error
(Sugihara 2011, "Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method"). A
foot that has arrived is left alone, and all operations are elementwise, so that no result depends
on the others of a batch.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hexapods.domain.model_geometry import Chain
from hexapods.domain.types import FloatArray

_ROUNDS = 14
"""Most rounds of the inverse kinematics; within reach two or three suffice."""
EXACT, NEAR = 3e-6, 6e-3
"""Errors, relative to the length of the leg, from which one more round suffices: it leaves the
square of them. The joint targets of a step need less, since they are interpolated."""
_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])
"""Indices of the other two of three axes."""
_DAMPING = 0.1
"""Damping, relative to the square of the error [rad²]."""
_LEAST_DAMPING = 1e-12
"""Least damping, relative to the square of the leg's length."""
_FLAT = 0.03
"""Ratio of the least to the largest singular value below which a foot moves in a surface only."""
_HEIGHT_WEIGHT = 8.0
"""Weight of an error in height against one sideways, of a foot that moves in a surface."""
_HEIGHT_ERROR = 0.02
"""Largest error of such a foot's height, relative to the length of its leg."""
_RESTS = 1 / 30
"""Change of a round at which such a foot has arrived [rad], relative to `EXACT` or `NEAR`."""
_FITTED_BOX = np.array([(-0.2, 0.2), (-0.2, 0.2), (-0.05, 0.2)])
"""Where the first angles are fitted, relative to the distance of the foot from the first joint."""
_FITTED_PER_AXIS = 9
_MONOMIALS = 19
"""Number of monomials of three variables, of degrees 1 to 3."""


class FootParameters(NamedTuple):
    """Inputs of `ChainSolver.solve` for each foot: parts of the rows of its leg; see `_Rows`."""

    to_first: FloatArray
    stages: FloatArray
    expansion: FloatArray
    foot: FloatArray
    squared_length: FloatArray
    weights: FloatArray
    is_flat: NDArray[np.bool_]


class _Rows(NamedTuple):
    """Slices of an array's rows with the parameters of a chain, each flattened."""

    to_first: slice
    """Rotation of the body frame to that of the first joint, (3, 3)."""
    stages: slice
    """For each joint the rotation of the next joint's frame to its own, and the place of the next
    joint's origin, or of the foot, (3, 4, joints)."""
    expansion: slice
    """Coefficients of `_monomials` that give the first angles, (7, joints, 3)."""
    foot: slice
    """The foot in the frame of the first joint where the leg stands, (3,)."""
    length: slice
    """Length of the leg from joint to joint [m]."""
    weights: slice
    """Weights of errors along the axes of the body, as a matrix for errors in the frame of the
    first joint, (3, 3)."""
    is_flat: slice
    """1 for a foot that moves in a surface only, or 0."""


class ChainSolver:
    """Forward and inverse kinematics of the chains of a robot's legs, by angles from one pose.

    Attributes:
        max_joints: number of joints of the longest chain; shorter ones are padded with joints
            that do nothing.
        parameters: parameters of each leg for `solve`, (rows, legs).
        follows_grid: for each leg whether its foot can go to any place near its present one.
    """

    def __init__(self, chains: Sequence[Chain]) -> None:
        self.max_joints = max_joints = max(len(chain.axes) for chain in chains)
        sizes = 9, 12 * max_joints, 21 * max_joints, 3, 1, 9, 1
        ends = np.cumsum((0, *sizes)).tolist()
        self._rows = _Rows(*(slice(start, end) for start, end in pairwise(ends)))
        columns = [_parameters(chain, max_joints) for chain in chains]
        self.parameters = np.array(columns).T
        self.follows_grid = tuple(bool(column[-1] == 0) for column in columns)
        self._is_any_flat = not all(self.follows_grid)
        origins = np.array([chain.anchors_m[0] for chain in chains]).T
        self._origins_m = origins[:, None]
        fitted = [self._fitted(leg, chain) for leg, chain in enumerate(chains)]
        self.parameters[self._rows.expansion] = np.array(fitted).T

    def _fitted(self, leg: int, chain: Chain) -> FloatArray:
        """Return coefficients of first angles by least squares around the standing pose.

        Where too few places are within reach, they are those of the expansion.
        """
        parameters = self.parameters[:, leg]
        taylor: FloatArray = parameters[self._rows.expansion]
        size = float(np.linalg.norm(chain.foot_m - chain.anchors_m[0]))
        axes = [size * np.linspace(low, high, _FITTED_PER_AXIS) for low, high in _FITTED_BOX]
        places = np.stack(np.meshgrid(*axes), axis=0).reshape(3, -1)
        with np.errstate(invalid="ignore", over="ignore"):
            angles = self.solve(places, self.parameters_of(parameters[:, None]))
        is_reached = np.isfinite(angles[:, 0])
        if is_reached.sum() < 4 * _MONOMIALS:
            return taylor
        to_first = parameters[self._rows.to_first].reshape(3, 3)
        # Relative to the size, so that all coefficients are of one order.
        terms = _monomials(to_first @ places[:, is_reached] / size)
        terms = np.moveaxis(terms, -1, 0).reshape(-1, 21)[:, :_MONOMIALS]
        fitted, *_ = np.linalg.lstsq(terms, angles[is_reached], rcond=None)
        degrees = np.repeat((1, 2, 2, 3, 3, 3, 3), 3)[:_MONOMIALS]
        coefficients = np.zeros((21, self.max_joints))
        coefficients[:_MONOMIALS] = fitted / size ** degrees[:, None]
        return np.moveaxis(coefficients.reshape(7, 3, -1), 1, 2).ravel()

    def feet_m(self, turned: FloatArray) -> FloatArray:
        """Return the centres of the feet in the body frame, (3, k, legs).

        Args:
            turned: angles of the joints from the standing pose, (max_joints, k, legs).
        """
        parameters = self.parameters[:, None]
        vectors = self._vectors(turned, self._stages(parameters))
        in_first = vectors[:, -1]
        to_first = parameters[self._rows.to_first].reshape(3, 3, *parameters.shape[1:])
        # Its inverse is its transpose.
        in_body = to_first[0] * in_first[0] + to_first[1] * in_first[1] + to_first[2] * in_first[2]
        feet: FloatArray = in_body + self._origins_m
        return feet

    def parameters_of(self, columns: FloatArray) -> FootParameters:
        """Return the parameters of feet for `solve`, from their legs' columns, (rows, ...)."""
        rows, each = self._rows, columns.shape[1:]
        length = columns[rows.length][0]
        return FootParameters(
            columns[rows.to_first].reshape(3, 3, *each),
            self._stages(columns),
            columns[rows.expansion].reshape(7, self.max_joints, 3, *each),
            columns[rows.foot],
            length * length,
            columns[rows.weights].reshape(3, 3, *each),
            columns[rows.is_flat][0] > 0,
        )

    def solve(self, offsets: FloatArray, feet: FootParameters, near: float = EXACT) -> FloatArray:
        """Return the angles of joints that move feet from where they stand.

        Args:
            offsets: displacements of the feet in the body frame, (3, ...) [m].
            feet: their parameters.
            near: error from which one more round suffices, relative to the length of the leg.

        Returns:
            Angles from the standing pose, (..., max_joints) [rad]; NaN where out of reach.
        """
        moved = _product(feet.to_first, offsets)
        target = feet.foot + moved
        turned = _expanded(feet.expansion, moved)
        is_there = np.zeros(offsets.shape[1:], bool)
        for _ in range(_ROUNDS):
            vectors = self._vectors(turned, feet.stages)
            error, columns = target - vectors[:, -1], vectors[:, :-1]
            if self._is_any_flat:
                error = _product(feet.weights, error)
                columns = _product(feet.weights[:, :, None], columns)
            squared = error * error
            missing = squared[0] + squared[1] + squared[2]
            damping = _DAMPING * missing + _LEAST_DAMPING * feet.squared_length
            change = _damped_step(columns, error, damping)
            turned += np.where(is_there, 0.0, change)
            is_there |= missing <= near * near * feet.squared_length
            if self._is_any_flat:
                rests = np.add.reduce(change * change)
                is_there |= feet.is_flat & (rests <= _RESTS * near * _RESTS * near)
            if is_there.all():
                break
        if not is_there.all() or self._is_any_flat:
            turned = np.where(self._is_reached(turned, target, feet, is_there), turned, np.nan)
        return np.ascontiguousarray(np.moveaxis(turned, 0, -1))

    def _is_reached(
        self,
        turned: FloatArray,
        target: FloatArray,
        feet: FootParameters,
        is_there: NDArray[np.bool_],
    ) -> NDArray[np.bool_]:
        """Return for each foot whether it has arrived; if it moves in a surface, at its height."""
        if not self._is_any_flat:
            return is_there
        error = target - self._vectors(turned, feet.stages)[:, -1]
        height = (
            feet.to_first[0, 2] * error[0]
            + feet.to_first[1, 2] * error[1]
            + feet.to_first[2, 2] * error[2]
        )
        is_level = height * height <= _HEIGHT_ERROR * _HEIGHT_ERROR * feet.squared_length
        reached: NDArray[np.bool_] = np.where(feet.is_flat, is_level, is_there)
        return reached

    def _stages(self, parameters: FloatArray) -> FloatArray:
        return parameters[self._rows.stages].reshape(3, 4, self.max_joints, *parameters.shape[1:])

    def _vectors(self, turned: FloatArray, stages: FloatArray) -> FloatArray:
        """Return the columns of the foot's Jacobian and its position, in the first joint's frame.

        Args:
            turned: angles of the joints, (max_joints, ...).
            stages: (3, 4, max_joints, ...).

        Returns:
            (3, max_joints + 1, ...): a column for each joint; the last is the position of the foot.
        """
        cos, sin, max_joints = np.cos(turned), np.sin(turned), self.max_joints
        # For each joint: from the next joint's frame to its own, then turned about its z axis.
        turns = np.empty((3, 4, *turned.shape))
        turns[0] = cos * stages[0] - sin * stages[1]
        turns[1] = sin * stages[0] + cos * stages[1]
        turns[2] = stages[2]
        vectors = np.empty((3, max_joints + 1, *turned.shape[1:]))
        for joint in reversed(range(max_joints)):
            turn = turns[:, :, joint]
            if joint == max_joints - 1:
                vectors[:, max_joints] = turn[:, 3]
            else:
                outer = vectors[:, joint + 1 :]
                outer[...] = (
                    turn[:, 0, None] * outer[0]
                    + turn[:, 1, None] * outer[1]
                    + turn[:, 2, None] * outer[2]
                )
                outer[:, -1] += turn[:, 3]
            np.negative(vectors[1, max_joints], out=vectors[0, joint])
            vectors[1, joint], vectors[2, joint] = vectors[0, max_joints], 0.0
        return vectors


def _product(matrix: FloatArray, vector: FloatArray) -> FloatArray:
    """Return matrices times vectors, elementwise over the last axes, (3, ...)."""
    product: FloatArray = (
        matrix[:, 0] * vector[0] + matrix[:, 1] * vector[1] + matrix[:, 2] * vector[2]
    )
    return product


def _expanded(expansion: FloatArray, moved: FloatArray) -> FloatArray:
    """Return angles by polynomials of an offset, (max_joints, ...).

    Args:
        expansion: coefficients, (7, max_joints, 3, ...).
        moved: the offset in the frame of the first joint, (3, ...).
    """
    terms = expansion * _monomials(moved)[:, None]
    sums: FloatArray = terms[0]
    for group in range(1, 7):
        sums = sums + terms[group]
    angles: FloatArray = sums[:, 0] + sums[:, 1] + sums[:, 2]
    return angles


def _monomials(moved: FloatArray) -> FloatArray:
    """Return the monomials of three numbers up to degree 3, (7, 3, ...); the last two are 0.

    They are x y z; xx yy zz; xy yz zx; xxx yyy zzz; xxy yyz zzx; xxz yyx zzy; xyz.
    """
    products = np.zeros((7, *moved.shape))
    after = moved.take(_NEXT, 0)
    products[0] = moved
    squares = np.multiply(moved, moved, out=products[1])
    np.multiply(moved, after, out=products[2])
    np.multiply(squares, moved, out=products[3])
    np.multiply(squares, after, out=products[4])
    np.multiply(squares, moved.take(_LAST, 0), out=products[5])
    np.multiply(products[2, 0], moved[2], out=products[6, 0])
    return products


def _damped_step(columns: FloatArray, error: FloatArray, damping: FloatArray) -> FloatArray:
    """Return Jᵀ (J Jᵀ + damping)⁻¹ error, (max_joints, n), by cofactors of the symmetric matrix.

    Args:
        columns: J, (3, max_joints, n).
        error: (3, n).
        damping: (n,).
    """
    diagonals, off_diagonals = columns * columns, columns * columns.take(_NEXT, 0)
    diagonal, off_diagonal = diagonals[:, 0] + damping, off_diagonals[:, 0]  # xx yy zz; xy yz zx
    for joint in range(1, columns.shape[1]):
        diagonal = diagonal + diagonals[:, joint]
        off_diagonal = off_diagonal + off_diagonals[:, joint]
    next_diagonal, last_diagonal = diagonal.take(_NEXT, 0), diagonal.take(_LAST, 0)
    next_off, last_off = off_diagonal.take(_NEXT, 0), off_diagonal.take(_LAST, 0)
    cofactors = next_diagonal * last_diagonal - next_off * next_off
    mixed = next_off * last_off - off_diagonal * last_diagonal
    determinant = (
        diagonal[0] * cofactors[0] + off_diagonal[0] * mixed[0] + off_diagonal[2] * mixed[2]
    )
    solved = (
        cofactors * error
        + mixed * error.take(_NEXT, 0)
        + mixed.take(_LAST, 0) * error.take(_LAST, 0)
    )
    solved = solved / determinant
    products = columns * solved[:, None]
    step: FloatArray = products[0] + products[1] + products[2]
    return step


def _parameters(chain: Chain, max_joints: int) -> FloatArray:
    """Return the parameters of a leg for `ChainSolver`, in the order of `_Rows`."""
    count = len(chain.axes)
    frames = [_frame_about(axis) for axis in chain.axes]  # columns are the axes of each joint
    origins = [*chain.anchors_m, chain.foot_m]
    stages = np.zeros((3, 4, max_joints))
    for joint in range(max_joints):
        stages[:, :3, joint] = np.eye(3)
        if joint < count:
            if joint + 1 < count:
                stages[:, :3, joint] = frames[joint].T @ frames[joint + 1]
            stages[:, 3, joint] = frames[joint].T @ (origins[joint + 1] - origins[joint])
    to_first = frames[0].T
    arms = chain.foot_m - chain.anchors_m
    columns = np.cross(chain.axes, arms)  # (joints, 3), in the body frame
    length = float(np.linalg.norm(np.diff(origins, axis=0), axis=1).sum())
    singular = np.linalg.svd(columns.T, compute_uv=False)
    is_flat = count < 3 or singular[2] < _FLAT * singular[0]
    weights = np.diag((1.0, 1.0, _HEIGHT_WEIGHT if is_flat else 1.0)) @ to_first.T
    return np.concatenate(
        (
            to_first.ravel(),
            stages.ravel(),
            _expansion(chain, columns @ to_first.T, to_first, max_joints, is_flat=is_flat).ravel(),
            to_first @ (chain.foot_m - origins[0]),
            [length],
            weights.ravel(),
            [float(is_flat)],
        )
    )


def _expansion(
    chain: Chain, columns: FloatArray, to_first: FloatArray, max_joints: int, *, is_flat: bool
) -> FloatArray:
    """Return the second-order expansion of the inverse about the standing pose, (7, max_joints, 3).

    J q + ½ H(q, q) = u is solved by q = A u − ½ A H(A u, A u), A the pseudoinverse of J. A foot
    that moves in a surface has none: it begins where it stands.
    """
    expansion = np.zeros((7, max_joints, 3))
    if is_flat:
        return expansion
    count = len(columns)
    inverse = np.linalg.pinv(columns.T)  # (joints, 3)
    axes = chain.axes @ to_first.T
    bend = np.empty((count, count, 3))
    for joint in range(count):
        for other in range(count):
            bend[joint, other] = np.cross(axes[min(joint, other)], columns[max(joint, other)])
    second = -0.5 * np.einsum("jc,abc,ax,by->jxy", inverse, bend, inverse, inverse)
    expansion[0, :count] = inverse
    for axis in range(3):
        after = (axis + 1) % 3
        expansion[1, :count, axis] = second[:, axis, axis]
        expansion[2, :count, axis] = second[:, axis, after] + second[:, after, axis]
    return expansion


def _frame_about(axis: FloatArray) -> FloatArray:
    """Return a rotation whose z axis is a unit vector, (3, 3)."""
    aside = np.eye(3)[int(np.argmin(np.abs(axis)))]
    x = np.cross(aside, axis)
    x /= np.linalg.norm(x)
    return np.stack((x, np.cross(axis, x), axis), axis=1)
