// Windows' and OS/2's BMP, as far as is needed to know the size, that the file is whole, and that the decoder takes its
// colours for what they are.
#pragma once
#include <string>
#include <string_view>

#include "io/raster_header.h"

namespace gonio::io {

bool is_bmp(std::string_view bytes);
RasterHeader read_bmp_header(std::string_view bytes, const std::string& place);  // Error(data) at `place`

}  // namespace gonio::io
