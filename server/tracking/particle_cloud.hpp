#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/tracking/scratch.hpp"

namespace wayfuse {

/// N particles as packed columns of floats (structure of arrays), each column padded to a multiple of 16.
///
/// Positions are metres in the pipeline's frame, which lies within a few kilometres of its origin, so that a float is good
/// to a millimetre. Weights are logarithms and need not be normalised. A column a motion model does not use stays empty.
/// Thread: confined to one session.
class ParticleCloud {
 public:
  enum Column : unsigned { kX, kY, kVx, kVy, kHeadingBias, kStrideScale, kSaid, kLogWeight, kColumns };
  /// Bit set of optional columns; x, y and the weight are always there.
  enum : unsigned { kVelocity = 1u << kVx | 1u << kVy, kBias = 1u << kHeadingBias, kScale = 1u << kStrideScale, kEcho = 1u << kSaid };
  /// With the columns: weights as logarithms alone, weights() is not asked for. A copy is a column smaller.
  static constexpr unsigned kLogsOnly = 1u << kColumns;

  ParticleCloud() = default;
  ParticleCloud(std::size_t size, unsigned optional_columns);

  std::size_t size() const { return size_; }
  /// Entries every column really holds: those past size() belong to nobody, and their log weights are -inf.
  std::size_t padded_size() const { return column_[kLogWeight].size(); }
  bool has(Column column) const { return !column_[column].empty(); }

  std::span<float> operator[](Column column) { return {column_[column].data(), has(column) ? size_ : 0}; }
  std::span<const float> operator[](Column column) const { return {column_[column].data(), has(column) ? size_ : 0}; }
  std::span<float> x_m() { return (*this)[kX]; }
  std::span<float> y_m() { return (*this)[kY]; }
  std::span<float> vx_mps() { return (*this)[kVx]; }
  std::span<float> vy_mps() { return (*this)[kVy]; }
  std::span<float> heading_bias_rad() { return (*this)[kHeadingBias]; }
  std::span<float> stride_scale() { return (*this)[kStrideScale]; }
  /// Log-likelihood of the newest scan: what the next one repeats of it is not counted again.
  std::span<float> said() { return (*this)[kSaid]; }
  std::span<float> log_weight() { return (*this)[kLogWeight]; }
  std::span<const float> x_m() const { return (*this)[kX]; }
  std::span<const float> y_m() const { return (*this)[kY]; }
  std::span<const float> vx_mps() const { return (*this)[kVx]; }
  std::span<const float> vy_mps() const { return (*this)[kVy]; }
  std::span<const float> heading_bias_rad() const { return (*this)[kHeadingBias]; }
  std::span<const float> stride_scale() const { return (*this)[kStrideScale]; }
  std::span<const float> log_weight() const { return (*this)[kLogWeight]; }

  /// Moves every particle by so much.
  void shift(double dx_m, double dy_m);
  /// Shifts the log weights so that the weights sum to 1. False, and equal weights, when no particle has a finite weight.
  bool normalise();
  /// 1 / sum of squared weights, as of the newest normalise(): 1..N.
  double effective_size() const { return effective_size_; }
  /// The weights themselves, as normalise() found them; they sum to 1 within 1e-5.
  std::span<const float> weights() const {
    assert(size_ == 0 || !weight_.empty());
    return {weight_.data(), size_};
  }
  /// Equal weights for all.
  void level();
  /// Particle i becomes a copy of particle ancestors()[i]; all weights become equal.
  void take_ancestors();
  /// Scratch for one number a particle, until the next normalise() or take_ancestors().
  std::span<float> scratch() { return spare_.get(padded_size()).first(size_); }
  /// Scratch for resamplers, one entry a particle.
  std::span<std::uint32_t> ancestors() { return ancestors_.get(padded_size()).first(size_); }

 private:
  std::size_t size_ = 0;
  std::vector<float> column_[kColumns];
  Scratch<float> spare_;
  std::vector<float> weight_;      // empty: logs only
  double effective_size_ = 0.0;
  Scratch<std::uint32_t> ancestors_;
};

}  // namespace wayfuse
