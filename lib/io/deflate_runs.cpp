// See deflate_runs.h.
#include "io/deflate_runs.h"

#include <algorithm>
#include <array>

namespace gonio::io {
namespace {

constexpr int symbols = 286, end_of_block = 256, first_length = 257;
constexpr std::uint64_t adler = 65521;

// Bits of every literal and length. Kraft's sum is 1, as readers demand: 1/2 for 258, 29/256 for the other lengths and
// the end, 1/64 for zero, 125/512 + 130/1024 for the rest.
constexpr std::array<int, symbols> lengths() {
  std::array<int, symbols> all{};
  for (int s = 0; s < symbols; ++s)
    all[static_cast<std::size_t>(s)] = s == 0 ? 6 : s < 256 ? (s <= 62 || s >= 193 ? 9 : 10) : s == symbols - 1 ? 1 : 8;
  return all;
}

struct Code {
  std::uint32_t bits = 0;  // as they are sent, the first lowest
  int count = 0;
};
// Canonical codes, RFC 1951, 3.2.2, their bits turned round.
template <std::size_t N>
constexpr std::array<Code, N> codes_of(const std::array<int, N>& lengths) {
  std::array<Code, N> all{};
  std::uint32_t next = 0;
  for (int length = 1; length <= 15; ++length) {
    next <<= 1;
    for (std::size_t s = 0; s < N; ++s) {
      if (lengths[s] != length) continue;
      std::uint32_t turned = 0;
      for (int k = 0; k < length; ++k) turned |= (next >> k & 1) << (length - 1 - k);
      all[s] = {turned, length};
      ++next;
    }
  }
  return all;
}
constexpr auto codes = codes_of(lengths());

// Symbol and further bits of a length from 3 to 258, RFC 1951, 3.2.5.
struct Length {
  int symbol = 0, extra = 0, base = 0;
};
constexpr std::array<Length, 259> length_table() {
  std::array<Length, 259> all{};
  int symbol = first_length, base = 3;
  for (; symbol < symbols - 1; ++symbol) {
    const int extra = symbol < 265 ? 0 : (symbol - 261) / 4;
    for (int k = base; k < std::min(259, base + (1 << extra)); ++k)
      all[static_cast<std::size_t>(k)] = {symbol, extra, base};
    base += 1 << extra;
  }
  all[258] = {symbols - 1, 0, 258};
  return all;
}
constexpr auto length_codes = length_table();

// Lengths of the code of code lengths; those that occur are 1, 6, 8, 9, 10.
constexpr std::array<int, 19> head_lengths() {
  std::array<int, 19> all{};
  all[10] = 1, all[9] = 2, all[8] = 3, all[6] = 4, all[1] = 4;
  return all;
}
constexpr auto head_codes = codes_of(head_lengths());
constexpr std::array<int, 19> head_order{16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};

}  // namespace

RunDeflate::RunDeflate() {
  out_ = {'\x78', '\x01'};
  bits(1, 1), bits(2, 2);              // the last block, with codes of its own:
  bits(symbols - 257, 5), bits(0, 5);  // of so many literals and lengths, and one distance
  constexpr int sent = 18;             // of head_order, up to 1
  bits(sent - 4, 4);
  for (int k = 0; k < sent; ++k)
    bits(static_cast<std::uint64_t>(head_lengths()[static_cast<std::size_t>(head_order[static_cast<std::size_t>(k)])]),
         3);
  const auto length = [&](int value) {
    const Code& code = head_codes[static_cast<std::size_t>(value)];
    bits(code.bits, code.count);
  };
  for (const int value : lengths()) length(value);
  length(1);  // of the distance 1
}

void RunDeflate::bits(std::uint64_t value, int count) {
  held_ |= value << held_bits_;
  for (held_bits_ += count; held_bits_ >= 8; held_bits_ -= 8, held_ >>= 8) out_ += static_cast<char>(held_ & 0xff);
}

void RunDeflate::put(std::uint8_t byte, std::size_t count) {
  if (count == 0) return;
  if (count_ > 0 && byte == byte_) {
    count_ += count;
    return;
  }
  run();
  byte_ = byte, count_ = count;
}

void RunDeflate::run() {
  if (count_ == 0) return;
  // Sums over n bytes v: b += n a + v n (n + 1) / 2, a += n v.
  const std::uint64_t n = count_ % adler, pairs = count_ % 2 == 0 ? count_ / 2 % adler * ((count_ + 1) % adler) % adler
                                                                  : (count_ + 1) / 2 % adler * n % adler;
  b_ = (b_ + n * a_ + byte_ * pairs) % adler;
  a_ = (a_ + n * byte_) % adler;
  const Code& literal = codes[byte_];
  bits(literal.bits, literal.count);
  ++literals_;
  std::size_t left = count_ - 1;
  const auto repeat = [&](std::size_t length) {
    const Length& l = length_codes[length];
    const Code& code = codes[static_cast<std::size_t>(l.symbol)];
    bits(code.bits, code.count), bits(length - static_cast<std::size_t>(l.base), l.extra), bits(0, 1);
  };
  for (; left >= 258; left -= 258) repeat(258);
  if (left >= 3) {
    repeat(left);
    left = 0;
  }
  for (; left > 0; --left, ++literals_) bits(literal.bits, literal.count);
  count_ = 0;
}

std::string RunDeflate::finish() {
  run();
  bits(codes[end_of_block].bits, codes[end_of_block].count);
  if (held_bits_ > 0) out_ += static_cast<char>(held_ & 0xff);
  for (const std::uint64_t sum : {b_, a_}) out_ += static_cast<char>(sum >> 8), out_ += static_cast<char>(sum & 0xff);
  return std::move(out_);
}

}  // namespace gonio::io
