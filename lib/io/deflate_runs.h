// A zlib stream (RFC 1950, 1951) of bytes that come in long runs, as pictures of layers do once every row is taken off
// the one above it: written run by run, so that its cost is that of the runs and not of the bytes. libdeflate and zlib
// look at every byte, 3 to 7 ms for a picture of 4 million; this takes a tenth. Of bytes without runs it makes more
// than they were: for those use libdeflate.
//
// One block with dynamic codes that are always the same: a repeat of the last byte 258 times is 2 bits, shorter repeats
// 9 to 14, a zero 6, other bytes 9 or 10. For this room.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

namespace gonio::io {

class RunDeflate {
 public:
  RunDeflate();
  void put(std::uint8_t byte, std::size_t count);
  // Bytes that were written one by one, rather than as repeats: what it is not made for.
  std::size_t literals() const { return literals_; }
  std::string finish();  // the whole stream

 private:
  void bits(std::uint64_t value, int count);
  void run();  // the pending one

  std::string out_;
  std::uint64_t held_ = 0;
  int held_bits_ = 0;
  std::size_t literals_ = 0;
  std::uint8_t byte_ = 0;
  std::size_t count_ = 0;        // pending
  std::uint64_t a_ = 1, b_ = 0;  // Adler's sums
};

}  // namespace gonio::io
