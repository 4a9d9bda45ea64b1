// Sums that come out the same to the last bit whatever the order of their terms, so that passes may be rendered on many
// machines, stopped and resumed, and joined to exactly the picture of one run.
//
// Fixed point with the unit 2^-56: a term is a float, cut to a whole number q of units (floats from 2^-32 on are whole
// anyway). Sums of q have 128 bits, sums of q^2 have 192; integer addition is associative. The variance of the mean of
// n terms,
//   (n sum q^2 - (sum q)^2) / (n^2 (n - 1)),
// is found in integers, too: equal terms have none, exactly. Terms beyond 2^31, sums of squares beyond 2^80, and what
// is no number make the sum no number for good.
#pragma once
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace gonio::render {

__extension__ using Wide = __int128;
__extension__ using UnsignedWide = unsigned __int128;

inline constexpr int fixed_point_bits = 56;
inline constexpr double largest_term = 0x1p31;

// A float as a whole number of units: +-mantissa * 2^shift.
struct FixedTerm {
  bool valid = false, negative = false;
  std::uint64_t mantissa = 0;
  int shift = 0;  // >= 0
  explicit FixedTerm(float v) {
    if (!(std::abs(v) <= largest_term)) return;
    const auto bits = std::bit_cast<std::uint32_t>(v);
    const int exponent = static_cast<int>((bits >> 23) & 0xffu);
    valid = true;
    negative = (bits >> 31) != 0;
    mantissa = exponent > 0 ? (bits & 0x7fffffu) | 0x800000u : bits & 0x7fffffu;
    shift = (exponent > 0 ? exponent : 1) - 150 + fixed_point_bits;
    if (shift >= 0) return;
    mantissa = shift > -24 ? mantissa >> -shift : 0;
    shift = 0;
  }
};

class ExactSum {
 public:
  void add(float v) {
    const FixedTerm term(v);
    if (!term.valid) return spoil();
    const auto q = static_cast<Wide>(UnsignedWide{term.mantissa} << term.shift);
    add(term.negative ? -q : q);
  }
  void add(const ExactSum& other) {
    if (other.spoilt()) return spoil();
    add(other.units());
  }
  bool spoilt() const { return high_ == spoilt_mark && low_ == 0; }
  Wide units() const { return static_cast<Wide>((UnsignedWide{static_cast<std::uint64_t>(high_)} << 64) | low_); }
  double value() const {
    if (spoilt()) return std::numeric_limits<double>::quiet_NaN();
    return std::ldexp(static_cast<double>(units()), -fixed_point_bits);
  }
  bool operator==(const ExactSum&) const = default;

 private:
  static constexpr std::int64_t spoilt_mark = std::numeric_limits<std::int64_t>::min();
  void spoil() { high_ = spoilt_mark, low_ = 0; }
  void add(Wide q) {
    if (spoilt()) return;
    const Wide sum = units() + q;  // 2^31 * 2^31 terms have room
    high_ = static_cast<std::int64_t>(sum >> 64);
    low_ = static_cast<std::uint64_t>(sum);
  }
  std::uint64_t low_ = 0;
  std::int64_t high_ = 0;
};

class ExactSquares {
 public:
  void add(float v);
  void add(const ExactSquares& other);
  const std::array<std::uint64_t, 3>& limbs() const { return limbs_; }  // least significant first
  bool operator==(const ExactSquares&) const = default;

 private:
  static constexpr std::uint64_t full = ~std::uint64_t{0};
  bool spoilt() const { return limbs_[0] == full && limbs_[1] == full && limbs_[2] == full; }
  void add(const std::array<std::uint64_t, 3>& other);
  std::array<std::uint64_t, 3> limbs_{};
};

// Of the mean of `count` terms, at least 2; not a number where a sum is none.
double variance_of_mean(const ExactSum& sum, const ExactSquares& squares, std::uint32_t count);

}  // namespace gonio::render
