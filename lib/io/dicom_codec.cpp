#include "io/dicom_codec.h"

#include <fcntl.h>
#include <unistd.h>

#include <exception>

#include "base/loaded_library.h"
#include "io/dicom_codec_module.h"
#include "io/volume_grid.h"

namespace gonio::io {
namespace {

// Codecs below GDCM write what they meet to the stream of errors, past its switches: the refusal is one line, ours.
// While it lives nothing of this process is written there.
class SilentErrors {
 public:
  SilentErrors() : kept_(::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3)) {
    const int nowhere = kept_ < 0 ? -1 : ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere < 0) return;
    ::dup2(nowhere, STDERR_FILENO);
    ::close(nowhere);
  }
  ~SilentErrors() {
    if (kept_ < 0) return;
    ::dup2(kept_, STDERR_FILENO);
    ::close(kept_);
  }
  SilentErrors(const SilentErrors&) = delete;
  SilentErrors& operator=(const SilentErrors&) = delete;

 private:
  int kept_;
};

}  // namespace

std::string decode_by_gdcm(const DicomFile& file, std::string_view stored, int bits, bool is_signed) {
  const std::string place = file.path.string();
  static const auto decode = loaded_from_module<decltype(gonio_decode_dicom)>("dicom_codec", "gonio_decode_dicom");
  std::string out(file.frame_bytes(), '\0');
  bool decoded = false;
  try {
    const SilentErrors silent;
    decoded = decode(file, stored, bits, is_signed, out);
  } catch (const std::exception&) {
    decoded = false;
  }
  if (!decoded)
    refuse_volume(place, "has pixels that cannot be decoded (" + file.syntax + ")", "export the series anew");
  return out;
}

}  // namespace gonio::io
