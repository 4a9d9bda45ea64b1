// Whole numbers of 192 and 256 bits, as far as a variance needs them; see exact_sum.h.
#include "render/exact_sum.h"

namespace gonio::render {
namespace {

using Limbs = std::array<std::uint64_t, 4>;  // 256 bits, least significant first

// number * factor for numbers whose product has 256 bits at most.
template <std::size_t n>
void add_product(Limbs& to, const std::array<std::uint64_t, n>& number, std::uint64_t factor, std::size_t place) {
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i + place < to.size(); ++i) {
    const UnsignedWide product = (i < n ? UnsignedWide{number[i]} * factor : UnsignedWide{0}) + to[i + place] + carry;
    to[i + place] = static_cast<std::uint64_t>(product);
    carry = static_cast<std::uint64_t>(product >> 64);
  }
}

// a - b for a >= b.
Limbs difference(const Limbs& a, const Limbs& b) {
  Limbs result{};
  std::uint64_t borrow = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const UnsignedWide taken = UnsignedWide{b[i]} + borrow;
    borrow = taken > a[i] ? 1 : 0;
    result[i] = static_cast<std::uint64_t>(UnsignedWide{a[i]} - taken);
  }
  return result;
}

double to_double(const Limbs& limbs) {
  double sum = 0;
  for (std::size_t i = limbs.size(); i-- > 0;)
    sum += std::ldexp(static_cast<double>(limbs[i]), 64 * static_cast<int>(i));
  return sum;
}

}  // namespace

void ExactSquares::add(float v) {
  const FixedTerm term(v);
  if (!term.valid) {
    limbs_.fill(full);
    return;
  }
  const std::uint64_t square = term.mantissa * term.mantissa;  // 48 bits
  const int shift = 2 * term.shift;                            // at most 126
  std::array<std::uint64_t, 3> limbs{};
  const auto limb = static_cast<std::size_t>(shift / 64);
  const UnsignedWide placed = UnsignedWide{square} << (shift % 64);
  limbs[limb] = static_cast<std::uint64_t>(placed);
  if (limb + 1 < limbs.size()) limbs[limb + 1] = static_cast<std::uint64_t>(placed >> 64);
  add(limbs);
}

void ExactSquares::add(const ExactSquares& other) {
  if (other.spoilt())
    limbs_.fill(full);
  else
    add(other.limbs_);
}

void ExactSquares::add(const std::array<std::uint64_t, 3>& other) {
  if (spoilt()) return;
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i < limbs_.size(); ++i) {
    const UnsignedWide sum = UnsignedWide{limbs_[i]} + other[i] + carry;
    limbs_[i] = static_cast<std::uint64_t>(sum);
    carry = static_cast<std::uint64_t>(sum >> 64);
  }
  if (carry != 0) limbs_.fill(full);
}

double variance_of_mean(const ExactSum& sum, const ExactSquares& squares, std::uint32_t count) {
  const auto& limbs = squares.limbs();
  const bool spoilt = limbs[0] == limbs[1] && limbs[1] == limbs[2] && limbs[0] == ~std::uint64_t{0};
  if (sum.spoilt() || spoilt || count < 2) return std::numeric_limits<double>::quiet_NaN();
  const Wide units = sum.units();
  const auto magnitude = static_cast<UnsignedWide>(units < 0 ? -units : units);
  const std::array<std::uint64_t, 2> q = {static_cast<std::uint64_t>(magnitude),
                                          static_cast<std::uint64_t>(magnitude >> 64)};
  Limbs of_squares{}, square_of_sum{};
  add_product(of_squares, limbs, count, 0);
  add_product(square_of_sum, q, q[0], 0);
  add_product(square_of_sum, q, q[1], 1);
  const double n = count;
  return std::ldexp(to_double(difference(of_squares, square_of_sum)), -2 * fixed_point_bits) / (n * n * (n - 1));
}

}  // namespace gonio::render
