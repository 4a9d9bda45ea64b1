// See npy_write.h.
#include "io/npy_write.h"

#include <bit>
#include <string>

#include "base/error.h"

namespace gonio::io {

static_assert(std::endian::native == std::endian::little);

NpyWriter::NpyWriter(const std::filesystem::path& path, const std::vector<std::size_t>& size) : file_(path) {
  std::string shape;
  for (const std::size_t n : size) shape += std::to_string(n) + ", ", left_ *= n;
  if (size.size() > 1) shape.resize(shape.size() - 2);  // of one number the tuple needs its comma
  std::string head = "{'descr': '<f4', 'fortran_order': False, 'shape': (" + shape + "), }";
  constexpr std::size_t before = 10, unit = 64;
  head.resize((before + head.size() + 1 + unit - 1) / unit * unit - before - 1, ' ');
  head += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(head.size() & 0xff), bytes += static_cast<char>(head.size() >> 8);
  file_.append(bytes + head);
}

void NpyWriter::append(std::span<const float> numbers) {
  if (numbers.size() > left_) throw Error(Exit::internal, "npy", "gets more numbers than its size says");
  left_ -= numbers.size();
  file_.append({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float)});
}

void NpyWriter::commit() {
  if (left_ > 0) throw Error(Exit::internal, "npy", "lacks " + std::to_string(left_) + " numbers");
  file_.commit();
}

}  // namespace gonio::io
