#include "io/dicom_codec.h"

#include <fcntl.h>
#include <gdcmByteValue.h>
#include <gdcmDataElement.h>
#include <gdcmFragment.h>
#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>
#include <unistd.h>

#include <exception>

#include "io/volume_grid.h"

namespace gonio::io {
namespace {

gdcm::TransferSyntax gdcm_syntax(DicomPixels pixels) {
  switch (pixels) {
    case DicomPixels::jpeg_ls: return gdcm::TransferSyntax::JPEGLSLossless;
    case DicomPixels::jpeg_2000: return gdcm::TransferSyntax::JPEG2000Lossless;
    default: return gdcm::TransferSyntax::JPEGLosslessProcess14_1;
  }
}

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
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  gdcm::Image image;
  image.SetNumberOfDimensions(2);
  image.SetDimension(0, static_cast<unsigned>(file.columns));
  image.SetDimension(1, static_cast<unsigned>(file.rows));
  const auto allocated = static_cast<unsigned short>(file.bits_allocated), used = static_cast<unsigned short>(bits);
  image.SetPixelFormat(gdcm::PixelFormat(1, allocated, used, static_cast<unsigned short>(used - 1), is_signed ? 1 : 0));
  image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  image.SetTransferSyntax(gdcm_syntax(file.pixels));
  gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = gdcm::SequenceOfFragments::New();
  gdcm::Fragment fragment;
  fragment.SetByteValue(stored.data(), gdcm::VL(static_cast<std::uint32_t>(stored.size())));
  fragments->AddFragment(fragment);
  gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010));
  pixels.SetVR(gdcm::VR::OB);
  pixels.SetValue(*fragments);
  image.SetDataElement(pixels);
  std::string out(file.frame_bytes(), '\0');
  bool decoded = false;
  try {
    const SilentErrors silent;
    decoded = image.GetBufferLength() == out.size() && image.GetBuffer(out.data());
  } catch (const std::exception&) {
    decoded = false;
  }
  if (!decoded)
    refuse_volume(place, "has pixels that cannot be decoded (" + file.syntax + ")", "export the series anew");
  return out;
}

}  // namespace gonio::io
