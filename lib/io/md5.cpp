// See md5.h. RFC 1321, section 3; the table is floor(2^32 |sin(i + 1)|).
#include "io/md5.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "io/little_endian.h"

namespace gonio::io {
namespace {

using State = std::array<std::uint32_t, 4>;

void digest_block(State& state, std::string_view block) {
  static const std::array<std::uint32_t, 64> table = [] {
    std::array<std::uint32_t, 64> t{};
    for (std::size_t i = 0; i < 64; ++i)
      t[i] = static_cast<std::uint32_t>(std::floor(4294967296.0 * std::abs(std::sin(static_cast<double>(i) + 1))));
    return t;
  }();
  static constexpr int turns[4][4] = {{7, 12, 17, 22}, {5, 9, 14, 20}, {4, 11, 16, 23}, {6, 10, 15, 21}};
  auto [a, b, c, d] = state;
  for (std::size_t i = 0; i < 64; ++i) {
    const std::size_t round = i / 16;
    const std::uint32_t mixed = round == 0   ? (b & c) | (~b & d)
                                : round == 1 ? (d & b) | (~d & c)
                                : round == 2 ? b ^ c ^ d
                                             : c ^ (b | ~d);
    const std::size_t word = (round == 0 ? i : round == 1 ? 5 * i + 1 : round == 2 ? 3 * i + 5 : 7 * i) % 16;
    const std::uint32_t sum = a + mixed + table[i] + stored_at<std::uint32_t>(block, 4 * word);
    a = d, d = c, c = b;
    b += std::rotl(sum, turns[round][i % 4]);
  }
  state[0] += a, state[1] += b, state[2] += c, state[3] += d;
}

}  // namespace

std::string md5(std::string_view bytes) {
  State state{0x67452301u, 0xefcdab89u, 0x98badcfeu, 0x10325476u};
  const std::size_t whole = bytes.size() / 64 * 64;
  for (std::size_t at = 0; at < whole; at += 64) digest_block(state, bytes.substr(at, 64));
  std::string rest(bytes.substr(whole));
  rest += '\x80';
  rest.resize((rest.size() + 8 + 63) / 64 * 64, '\0');
  store_at<std::uint64_t>(rest, rest.size() - 8, std::uint64_t{8} * bytes.size());
  for (std::size_t at = 0; at < rest.size(); at += 64) digest_block(state, std::string_view(rest).substr(at, 64));
  std::string text;
  for (const std::uint32_t word : state)
    for (int byte = 0; byte < 4; ++byte) {
      char two[3];
      std::snprintf(two, sizeof two, "%02x", (word >> (8 * byte)) & 0xffu);
      text += two;
    }
  return text;
}

}  // namespace gonio::io
