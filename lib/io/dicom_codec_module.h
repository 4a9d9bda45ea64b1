// The module dicom_codec (base/loaded_library.h): GDCM, whose dictionary of all elements is made as it is loaded, 15
// ms.
#pragma once
#include <string>
#include <string_view>

#include "io/dicom_head.h"

extern "C" {
// One compressed frame into `out`, whose size is what it has to be; false where GDCM cannot.
bool gonio_decode_dicom(const gonio::io::DicomFile& file, std::string_view stored, int bits, bool is_signed,
                        std::string& out);
}
