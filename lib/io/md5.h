// The checksum that ISO 25178-72 asks for in its files (RFC 1321), as 32 lower-case hexadecimal digits. It tells
// damage, not forgery.
#pragma once
#include <string>
#include <string_view>

namespace gonio::io {

std::string md5(std::string_view bytes);

}  // namespace gonio::io
