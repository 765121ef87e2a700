#pragma once

#include <Eigen/Core>

namespace fringe {

/// A flat rectangular sensor plate: the points corner + a·edge_u + b·edge_v with a and b in [0, 1], in
/// metres.
struct Rectangle {
  Eigen::Vector3d corner;
  Eigen::Vector3d edge_u;
  Eigen::Vector3d edge_v;
};

/// Largest cosine of the angle between the edges that is rounding: single-precision rotations leave less once
/// cleaned up, and it is far below what the model's physics resolves.
constexpr double largest_cosine_of_rounding = 1e-9;

/// Throws InputError unless the rectangle is valid: finite, no edge of length zero, and |edge_u·edge_v| ≤
/// 1e-9·|edge_u|·|edge_v|.
void validate(const Rectangle& rectangle);

/// Largest cosine of the angle between two edges that squared() turns: drawings state coordinates with six
/// digits, which leave some 1e-5.
constexpr double largest_cosine_squared = 1e-4;

/// Returns the cosine of the angle between the edges, which must not have length zero.
double cosine_between_edges(const Rectangle& rectangle);

/// Returns the rectangle with its edges at right angles: each is turned by half of what is missing, and keeps
/// its length. The operations are those of the Python reader, one by one, so that both give the same bits.
Rectangle squared(const Rectangle& rectangle);

}  // namespace fringe
