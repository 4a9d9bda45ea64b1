// GDCM behind a narrow wall: its headers are read by one source, a module.
#pragma once
#include <string>
#include <string_view>

#include "io/dicom_head.h"

namespace gonio::io {

// Pixels of one compressed frame, little endian as GDCM gives them. Error(data) where it cannot.
std::string decode_by_gdcm(const DicomFile& file, std::string_view stored, int bits, bool is_signed);

}  // namespace gonio::io
