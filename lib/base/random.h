// Seeded random numbers that do not depend on threads: a generator is addressed by (seed, stream), and pixel 17 draws
// the same numbers whoever computes it. PCG32 (O'Neill 2014), the stream its increment, both hashed by SplitMix64.
#pragma once
#include <cmath>
#include <cstdint>

namespace gonio {

constexpr std::uint64_t split_mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0)
      : state_(0), increment_((split_mix(stream ^ 0x5851f42d4c957f2du) << 1) | 1u) {
    next();
    state_ += split_mix(seed);
    next();
  }
  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ull + increment_;
    const auto xorshifted = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
    const auto rot = static_cast<std::uint32_t>(old >> 59);
    return (xorshifted >> rot) | (xorshifted << ((32 - rot) & 31));
  }
  double uniform() { return (next() + 0.5) * 0x1p-32; }  // in (0, 1), never an end point
  double uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>((std::uint64_t{next()} * n) >> 32); }
  double normal() {  // Box-Muller, one of the pair: a generator has no hidden state besides its position
    const double u = uniform(), v = uniform();
    return std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586 * v);
  }

 private:
  std::uint64_t state_, increment_;
};

}  // namespace gonio
