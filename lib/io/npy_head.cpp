#include "io/npy_head.h"

#include <cctype>

#include "base/error.h"
#include "io/little_endian.h"

namespace gonio::io {
namespace {

constexpr std::size_t longest_head = 1 << 16, most_dimensions = 8;

// What stands behind 'key': in the head, without blanks before it.
std::string_view after(std::string_view head, std::string_view key, const std::string& place) {
  const std::string quoted = "'" + std::string(key) + "':";
  const auto at = head.find(quoted);
  if (at == std::string_view::npos) refuse_npy(place, "has no " + std::string(key) + " in its head");
  head.remove_prefix(at + quoted.size());
  while (!head.empty() && head.front() == ' ') head.remove_prefix(1);
  return head;
}

std::size_t number_at(std::string_view& text, const std::string& place) {
  std::size_t n = 0, digits = 0;
  for (; !text.empty() && std::isdigit(static_cast<unsigned char>(text.front())) != 0; ++digits) {
    n = 10 * n + static_cast<std::size_t>(text.front() - '0');
    if (digits > 17) refuse_npy(place, "has a size of more than 18 digits");
    text.remove_prefix(1);
  }
  if (digits == 0) refuse_npy(place, "has a head that cannot be read");
  return n;
}

void read_shape(std::string_view text, NpyHead& head, const std::string& place, std::uint64_t most_elements) {
  if (text.empty() || text.front() != '(') refuse_npy(place, "has no size in its head");
  text.remove_prefix(1);
  while (!text.empty() && text.front() != ')') {
    if (text.front() == ',' || text.front() == ' ') {
      text.remove_prefix(1);
      continue;
    }
    const std::size_t n = number_at(text, place);
    if (!text.empty() && text.front() == 'L') text.remove_prefix(1);  // of Python 2
    if (head.size.size() == most_dimensions) refuse_npy(place, "has more than 8 dimensions");
    if (n != 0 && head.count > most_elements / n) refuse_npy(place, "claims more numbers than a file can hold");
    head.size.push_back(n);
    head.count *= n;
  }
}

void read_type(std::string_view text, NpyHead& head, const std::string& place) {
  if (text.empty() || (text.front() != '\'' && text.front() != '"'))
    refuse_npy(place, "is a record of several fields", "write one array for each field");
  text.remove_prefix(1);
  char order = '|';
  if (!text.empty() && std::string_view("<>|=").find(text.front()) != std::string_view::npos)
    order = text.front(), text.remove_prefix(1);
  head.swapped = order == '>';
  if (text.empty()) refuse_npy(place, "has no type in its head");
  head.kind = text.front();
  text.remove_prefix(1);
  if (head.kind == 'O') return;
  if (head.kind == '?') {
    head.kind = 'b', head.bytes = 1;
    return;
  }
  head.bytes = number_at(text, place);
}

}  // namespace

void refuse_npy(const std::string& place, const std::string& problem, const std::string& hint) {
  throw Error(Exit::data, place, problem, hint);
}

NpyHead npy_head(std::string_view& bytes, const std::string& place, std::uint64_t most_elements) {
  if (bytes.size() < 10 || !bytes.starts_with("\x93NUMPY")) refuse_npy(place, "is no NumPy array");
  const bool wide = bytes[6] >= 2;
  const std::size_t start = wide ? 12 : 10;
  if (bytes.size() < start) refuse_npy(place, "ends within its head");
  const std::size_t length = wide ? stored_at<std::uint32_t>(bytes, 8) : stored_at<std::uint16_t>(bytes, 8);
  if (length > longest_head || bytes.size() - start < length) refuse_npy(place, "ends within its head");
  const std::string_view text = bytes.substr(start, length);
  bytes.remove_prefix(start + length);
  NpyHead head;
  read_type(after(text, "descr", place), head, place);
  head.fortran = after(text, "fortran_order", place).starts_with("True");
  read_shape(after(text, "shape", place), head, place, most_elements);
  return head;
}

}  // namespace gonio::io
