#include "server/tracking/particle_kernels.hpp"

#include <cstring>
#include <limits>
#include <numbers>

#include "server/tracking/noise.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/tracking/particle_kernels.cpp"
#include <hwy/foreach_target.h>  // compiles this file once a vector unit
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace wayfuse::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Words = hn::RebindToUnsigned<Floats>;
using Ints = hn::RebindToSigned<Floats>;
using F = hn::Vec<Floats>;
using U = hn::Vec<Words>;
using I = hn::Vec<Ints>;

// Noise::mix.
HWY_INLINE U Mix(U x) {
  const Words d;
  x = hn::Xor(x, hn::ShiftRight<16>(x));
  x = hn::Mul(x, hn::Set(d, 0x7feb352du));
  x = hn::Xor(x, hn::ShiftRight<15>(x));
  x = hn::Mul(x, hn::Set(d, 0x846ca68bu));
  return hn::Xor(x, hn::ShiftRight<16>(x));
}

// Horner's scheme without fused operations.
HWY_INLINE F Step(F sum, F x, float coefficient) { return hn::Add(hn::Mul(sum, x), hn::Set(Floats(), coefficient)); }

// log_of_unit() of noise.hpp.
HWY_INLINE F LogOfUnit(F u) {
  const Floats d;
  const Words dw;
  const Ints di;
  const U bits = hn::BitCast(dw, u);
  const I exponent = hn::Sub(hn::BitCast(di, hn::ShiftRight<23>(bits)), hn::Set(di, 127));
  const F m = hn::BitCast(d, hn::Or(hn::And(bits, hn::Set(dw, 0x7fffffu)), hn::Set(dw, 0x3f800000u)));
  const F t = hn::Div(hn::Sub(m, hn::Set(d, 1.0f)), hn::Add(m, hn::Set(d, 1.0f)));
  const F t2 = hn::Mul(t, t);
  F p = hn::Set(d, 1.0f / 9.0f);
  p = Step(p, t2, 1.0f / 7.0f);
  p = Step(p, t2, 1.0f / 5.0f);
  p = Step(p, t2, 1.0f / 3.0f);
  p = Step(p, t2, 1.0f);
  return hn::Add(hn::Mul(hn::ConvertTo(d, exponent), hn::Set(d, std::numbers::ln2_v<float>)), hn::Mul(hn::Add(t, t), p));
}

// cosine_and_sine_of_turn() of noise.hpp.
HWY_INLINE void CosineAndSine(F turn, F& cosine, F& sine) {
  const Floats d;
  const Ints di;
  const F r = hn::Mul(turn, hn::Set(d, 4.0f));
  const I q = hn::ConvertTo(di, hn::Add(r, hn::Set(d, 0.5f)));
  const F a = hn::Mul(hn::Sub(r, hn::ConvertTo(d, q)), hn::Set(d, std::numbers::pi_v<float> / 2));
  const F a2 = hn::Mul(a, a);
  F s = hn::Set(d, -1.0f / 5040.0f);
  s = Step(s, a2, 1.0f / 120.0f);
  s = Step(s, a2, -1.0f / 6.0f);
  s = Step(s, a2, 1.0f);
  s = hn::Mul(s, a);
  F c = hn::Set(d, 1.0f / 40320.0f);
  c = Step(c, a2, -1.0f / 720.0f);
  c = Step(c, a2, 1.0f / 24.0f);
  c = Step(c, a2, -0.5f);
  c = Step(c, a2, 1.0f);
  const auto set = [&](I value, int bit) { return hn::RebindMask(d, hn::Ne(hn::And(value, hn::Set(di, bit)), hn::Zero(di))); };
  const auto odd = set(q, 1);
  const F cos_part = hn::IfThenElse(odd, s, c), sin_part = hn::IfThenElse(odd, c, s);
  cosine = hn::IfThenElse(set(hn::Add(q, hn::Set(di, 1)), 2), hn::Neg(cos_part), cos_part);
  sine = hn::IfThenElse(set(q, 2), hn::Neg(sin_part), sin_part);
}

// Noise(key).normal(i) for the lanes from i on.
HWY_INLINE void Normals(std::size_t i, U low, U high, F& first, F& second) {
  const Floats d;
  const Words dw;
  const Ints di;
  const F ulp = hn::Set(d, 0x1.0p-24f);
  const U number = hn::Iota(dw, static_cast<std::uint32_t>(i));
  const U a = Mix(hn::Add(hn::Add(hn::Add(number, number), hn::Set(dw, 1u)), low));
  const U b = Mix(hn::Xor(a, high));
  const F u = hn::Mul(hn::Add(hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<8>(a))), hn::Set(d, 1.0f)), ulp);
  const F turn = hn::Mul(hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<8>(b))), ulp);
  const F radius = hn::Sqrt(hn::Max(hn::Mul(hn::Set(d, -2.0f), LogOfUnit(u)), hn::Zero(d)));
  F cosine, sine;
  CosineAndSine(turn, cosine, sine);
  first = hn::Mul(radius, cosine);
  second = hn::Mul(radius, sine);
}

void Walk(float* HWY_RESTRICT x_m, float* HWY_RESTRICT y_m, std::size_t padded, float dx_m, float dy_m, float sigma_m,
          std::uint64_t key) {
  const Floats d;
  const Words dw;
  const U low = hn::Set(dw, static_cast<std::uint32_t>(key)), high = hn::Set(dw, static_cast<std::uint32_t>(key >> 32));
  const F sigma = hn::Set(d, sigma_m), dx = hn::Set(d, dx_m), dy = hn::Set(d, dy_m);
  for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
    F first, second;
    Normals(i, low, high, first, second);
    hn::StoreU(hn::Add(hn::LoadU(d, x_m + i), hn::Add(dx, hn::Mul(sigma, first))), d, x_m + i);
    hn::StoreU(hn::Add(hn::LoadU(d, y_m + i), hn::Add(dy, hn::Mul(sigma, second))), d, y_m + i);
  }
}

void WalkTurned(float* HWY_RESTRICT x_m, float* HWY_RESTRICT y_m, const float* HWY_RESTRICT bias_rad, const float* HWY_RESTRICT scale,
                std::size_t padded, float dx_m, float dy_m, float sigma_m, std::uint64_t key) {
  const Floats d;
  const Words dw;
  const U low = hn::Set(dw, static_cast<std::uint32_t>(key)), high = hn::Set(dw, static_cast<std::uint32_t>(key >> 32));
  const F sigma = hn::Set(d, sigma_m), dx = hn::Set(d, dx_m), dy = hn::Set(d, dy_m);
  for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
    F first, second, cosine, sine;
    Normals(i, low, high, first, second);
    const F turns = hn::Mul(hn::LoadU(d, bias_rad + i), hn::Set(d, kTurnsPerRad));
    CosineAndSine(hn::Sub(turns, hn::Floor(turns)), cosine, sine);
    const F size = hn::LoadU(d, scale + i), c = hn::Mul(size, cosine), s = hn::Mul(size, sine);
    const F x = hn::Add(hn::Sub(hn::Mul(c, dx), hn::Mul(s, dy)), hn::Mul(sigma, first));
    const F y = hn::Add(hn::Add(hn::Mul(s, dx), hn::Mul(c, dy)), hn::Mul(sigma, second));
    hn::StoreU(hn::Add(hn::LoadU(d, x_m + i), x), d, x_m + i);
    hn::StoreU(hn::Add(hn::LoadU(d, y_m + i), y), d, y_m + i);
  }
}

void AddSquaredDistance(const float* HWY_RESTRICT x_m, const float* HWY_RESTRICT y_m, std::size_t size, float zx_m, float zy_m,
                        float scale, float* HWY_RESTRICT gained) {
  const Floats d;
  const F zx = hn::Set(d, zx_m), zy = hn::Set(d, zy_m), s = hn::Set(d, scale);
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= size; i += hn::Lanes(d)) {
    const F dx = hn::Sub(hn::LoadU(d, x_m + i), zx), dy = hn::Sub(hn::LoadU(d, y_m + i), zy);
    const F gain = hn::Mul(s, hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)));
    hn::StoreU(hn::Add(hn::LoadU(d, gained + i), gain), d, gained + i);
  }
  for (; i < size; ++i) {
    const float dx = x_m[i] - zx_m, dy = y_m[i] - zy_m;
    gained[i] += scale * (dx * dx + dy * dy);
  }
}

void Gather(const float* HWY_RESTRICT values, const std::uint32_t* HWY_RESTRICT from, std::size_t padded, float* HWY_RESTRICT out) {
  const Floats d;
  const Ints di;
  for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
    const I index = hn::BitCast(di, hn::LoadU(Words(), from + i));
    hn::StoreU(hn::GatherIndex(d, values, index), d, out + i);
  }
}

float CleanAndMax(float* HWY_RESTRICT log_weight, std::size_t padded) {
  const Floats d;
  const F lowest = hn::Set(d, -std::numeric_limits<float>::infinity());
  F most = lowest;
  for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
    const F weight = hn::LoadU(d, log_weight + i);
    const F clean = hn::IfThenElse(hn::Eq(weight, weight), weight, lowest);
    hn::StoreU(clean, d, log_weight + i);
    most = hn::Max(most, clean);
  }
  return hn::GetLane(hn::MaxOfLanes(d, most));
}

void SumsOfSixteen(const float* HWY_RESTRICT values, std::size_t padded, float* HWY_RESTRICT sums, float* HWY_RESTRICT squares) {
  const Floats d;
  for (std::size_t lane = 0; lane < 16; lane += hn::Lanes(d)) {
    F sum = hn::Zero(d), square = hn::Zero(d);
    for (std::size_t i = lane; i < padded; i += 16) {
      const F value = hn::LoadU(d, values + i);
      sum = hn::Add(sum, value);
      square = hn::Add(square, hn::Mul(value, value));
    }
    hn::StoreU(sum, d, sums + lane);
    hn::StoreU(square, d, squares + lane);
  }
}

void ShiftAndScale(float* HWY_RESTRICT shifted, float shift, float* HWY_RESTRICT scaled, float scale, std::size_t padded) {
  const Floats d;
  const F by = hn::Set(d, shift), times = hn::Set(d, scale);
  for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
    hn::StoreU(hn::Sub(hn::LoadU(d, shifted + i), by), d, shifted + i);
    hn::StoreU(hn::Mul(hn::LoadU(d, scaled + i), times), d, scaled + i);
  }
}

// Cephes' expf: 2^n times a polynomial on half a power of two to either side.
void Exponentials(const float* HWY_RESTRICT log_weight, std::size_t padded, float shift, float* HWY_RESTRICT out) {
  const Floats d;
  const Ints di;
  for (std::size_t i = 0; i < padded; i += hn::Lanes(d)) {
    const F raw = hn::Sub(hn::LoadU(d, log_weight + i), hn::Set(d, shift));
    const auto counts = hn::Ge(raw, hn::Set(d, -87.0f));
    const F x = hn::IfThenElseZero(counts, raw);
    const I n = hn::ConvertTo(di, hn::Sub(hn::Mul(x, hn::Set(d, std::numbers::log2e_v<float>)), hn::Set(d, 0.5f)));
    const F whole = hn::ConvertTo(d, n);
    F f = hn::Sub(x, hn::Mul(whole, hn::Set(d, 0.693359375f)));
    f = hn::Sub(f, hn::Mul(whole, hn::Set(d, -2.12194440e-4f)));
    F p = hn::Set(d, 1.9875691500e-4f);
    p = Step(p, f, 1.3981999507e-3f);
    p = Step(p, f, 8.3334519073e-3f);
    p = Step(p, f, 4.1665795894e-2f);
    p = Step(p, f, 1.6666665459e-1f);
    p = Step(p, f, 5.0000001201e-1f);
    p = hn::Add(hn::Add(hn::Mul(p, hn::Mul(f, f)), f), hn::Set(d, 1.0f));
    const F power = hn::BitCast(d, hn::ShiftLeft<23>(hn::Add(n, hn::Set(di, 127))));
    hn::StoreU(hn::IfThenElseZero(counts, hn::Mul(p, power)), d, out + i);
  }
}

}  // namespace wayfuse::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace wayfuse::kernels {

HWY_EXPORT(Walk);
HWY_EXPORT(WalkTurned);
HWY_EXPORT(AddSquaredDistance);
HWY_EXPORT(Gather);
HWY_EXPORT(CleanAndMax);
HWY_EXPORT(SumsOfSixteen);
HWY_EXPORT(ShiftAndScale);
HWY_EXPORT(Exponentials);

void walk(float* x_m, float* y_m, std::size_t padded, float dx_m, float dy_m, float sigma_m, std::uint64_t key) {
  HWY_DYNAMIC_DISPATCH(Walk)(x_m, y_m, padded, dx_m, dy_m, sigma_m, key);
}
void walk_turned(float* x_m, float* y_m, const float* bias_rad, const float* scale, std::size_t padded, float dx_m, float dy_m, float sigma_m,
                 std::uint64_t key) {
  HWY_DYNAMIC_DISPATCH(WalkTurned)(x_m, y_m, bias_rad, scale, padded, dx_m, dy_m, sigma_m, key);
}
void add_squared_distance(std::span<const float> x_m, std::span<const float> y_m, float zx_m, float zy_m, float scale,
                          std::span<float> gained) {
  HWY_DYNAMIC_DISPATCH(AddSquaredDistance)(x_m.data(), y_m.data(), x_m.size(), zx_m, zy_m, scale, gained.data());
}
void gather(const float* values, const std::uint32_t* from, std::size_t padded, float* out) {
  HWY_DYNAMIC_DISPATCH(Gather)(values, from, padded, out);
}
float clean_and_max(float* log_weight, std::size_t padded) { return HWY_DYNAMIC_DISPATCH(CleanAndMax)(log_weight, padded); }
void sums_of_sixteen(const float* values, std::size_t padded, std::array<float, 16>& sums, std::array<float, 16>& squares) {
  HWY_DYNAMIC_DISPATCH(SumsOfSixteen)(values, padded, sums.data(), squares.data());
}
void shift_and_scale(float* shifted, float shift, float* scaled, float scale, std::size_t padded) {
  HWY_DYNAMIC_DISPATCH(ShiftAndScale)(shifted, shift, scaled, scale, padded);
}
void exponentials(const float* log_weight, std::size_t padded, float shift, float* out) {
  HWY_DYNAMIC_DISPATCH(Exponentials)(log_weight, padded, shift, out);
}

std::size_t use_only_target_for_test(std::size_t n) {
  hwy::SetSupportedTargetsForTest(0);
  const auto targets = hwy::SupportedAndGeneratedTargets();
  if (n >= 1 && n <= targets.size()) hwy::SetSupportedTargetsForTest(static_cast<std::uint32_t>(targets[n - 1]));
  return targets.size();
}

}  // namespace wayfuse::kernels
#endif  // HWY_ONCE
