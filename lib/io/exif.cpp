// See exif.h.
#include "io/exif.h"

#include <libexif/exif-data.h>

#include <memory>

namespace gonio::io {
namespace {

// The first number of an entry.
std::optional<double> number_of(ExifData* data, ExifTag tag) {
  const ExifEntry* entry = exif_content_get_entry(data->ifd[EXIF_IFD_EXIF], tag);
  if (entry == nullptr || entry->data == nullptr || entry->components < 1) return std::nullopt;
  const ExifByteOrder order = exif_data_get_byte_order(data);
  double value = 0;
  if (entry->format == EXIF_FORMAT_RATIONAL && entry->size >= 8) {
    const ExifRational ratio = exif_get_rational(entry->data, order);
    value = ratio.denominator == 0 ? 0 : static_cast<double>(ratio.numerator) / ratio.denominator;
  } else if (entry->format == EXIF_FORMAT_SHORT && entry->size >= 2) {
    value = exif_get_short(entry->data, order);
  } else if (entry->format == EXIF_FORMAT_LONG && entry->size >= 4) {
    value = exif_get_long(entry->data, order);
  }
  return value > 0 ? std::optional(value) : std::nullopt;
}

}  // namespace

Exif exif_of(const std::filesystem::path& path) {
  const std::unique_ptr<ExifData, decltype(&exif_data_unref)> data(exif_data_new_from_file(path.c_str()),
                                                                   exif_data_unref);
  if (data == nullptr) return {};
  return {number_of(data.get(), EXIF_TAG_EXPOSURE_TIME), number_of(data.get(), EXIF_TAG_FNUMBER),
          number_of(data.get(), EXIF_TAG_ISO_SPEED_RATINGS)};
}

}  // namespace gonio::io
