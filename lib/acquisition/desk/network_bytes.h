// Numbers as the protocols of the simulated devices write them: the highest byte first.
#pragma once
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

namespace gonio::acquisition::desk {

class NetworkBytes {
 public:
  NetworkBytes& u8(std::uint32_t v) {
    bytes_.push_back(static_cast<char>(v & 255U));
    return *this;
  }
  NetworkBytes& u16(std::uint32_t v) { return u8(v >> 8U).u8(v); }
  NetworkBytes& u32(std::uint32_t v) { return u16(v >> 16U).u16(v); }
  NetworkBytes& u64(std::uint64_t v) {
    return u32(static_cast<std::uint32_t>(v >> 32U)).u32(static_cast<std::uint32_t>(v));
  }
  NetworkBytes& i32(std::int32_t v) { return u32(static_cast<std::uint32_t>(v)); }
  NetworkBytes& real(double v) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &v, sizeof bits);
    return u64(bits);
  }
  NetworkBytes& six(std::span<const double> v) {
    for (std::size_t i = 0; i < 6; ++i) real(i < v.size() ? v[i] : 0);
    return *this;
  }
  NetworkBytes& text(std::string_view v) {
    bytes_ += v;
    return *this;
  }
  const std::string& all() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace gonio::acquisition::desk
