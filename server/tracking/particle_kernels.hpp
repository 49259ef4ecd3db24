#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace wayfuse {

/// The inner loops of a particle filter, vectorised through Highway and dispatched at run time to the widest unit there is.
///
/// Every particle's result depends on its own numbers only, no multiplication is fused with an addition, and sums run in 16 fixed
/// lanes: the bits are the same on every vector width, and equal to the scalar reference in the tests. Columns given as pointers
/// hold a multiple of 16 entries. Threads: no state.
namespace kernels {

/// x += dx + sigma n1, y += dy + sigma n2 with Noise(key).normal(i).
void walk(float* x_m, float* y_m, std::size_t padded, float dx_m, float dy_m, float sigma_m, std::uint64_t key);
/// The same with (dx, dy) turned by each particle's own bias, counter-clockwise, and stretched by its own scale.
void walk_turned(float* x_m, float* y_m, const float* bias_rad, const float* scale, std::size_t padded, float dx_m, float dy_m, float sigma_m,
                 std::uint64_t key);
/// gained += scale ((x - zx)^2 + (y - zy)^2); any length.
void add_squared_distance(std::span<const float> x_m, std::span<const float> y_m, float zx_m, float zy_m, float scale,
                          std::span<float> gained);
/// out[i] = values[from[i]], below 2^31.
void gather(const float* values, const std::uint32_t* from, std::size_t padded, float* out);
/// NaN becomes -inf in place; the largest.
float clean_and_max(float* log_weight, std::size_t padded);
/// out = exp(log_weight - shift), differences at most 0; below -87 exactly 0.
void exponentials(const float* log_weight, std::size_t padded, float shift, float* out);

/// Sums and sums of squares of every sixteenth value, so that they do not depend on the machine.
void sums_of_sixteen(const float* values, std::size_t padded, std::array<float, 16>& sums, std::array<float, 16>& squares);
/// shifted -= shift, scaled *= scale.
void shift_and_scale(float* shifted, float shift, float* scaled, float scale, std::size_t padded);

/// Runs what follows on vector units no wider than the n-th of those this machine has, for tests; 0 = all again.
/// Returns how many there are.
std::size_t use_only_target_for_test(std::size_t n);

}  // namespace kernels
}  // namespace wayfuse
