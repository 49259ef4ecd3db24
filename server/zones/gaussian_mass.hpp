#pragma once

#include <span>

#include "wayfuse/proto/fix.hpp"
#include "wayfuse/proto/place.hpp"

namespace wayfuse {

/// A ring that adds area, or takes it away.
struct SignedRing {
  Ring ring;
  bool hole = false;
};

/// The probability that a point normally distributed about `mean` lies inside the rings, 0..1; error below 1e-5.
///
/// Green's theorem turns the integral over the area into one along its edges; in coordinates where the covariance is the
/// identity, an edge at distance h from the mean contributes h / 2 pi times the integral of (1 - exp(-r^2 / 2)) / r^2 along it,
/// a smooth function that Gauss-Legendre takes in pieces near the mean and that is 1 / r^2 away from it. A covariance below
/// (0.1 m)^2 is widened to it. Cost: some 30 exponentials an edge close to the mean, none for the others.
double gaussian_mass(BuildingPoint mean, const Covariance& covariance, std::span<const SignedRing> rings);

}  // namespace wayfuse
