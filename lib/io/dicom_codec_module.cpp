#include "io/dicom_codec_module.h"

#include <gdcmByteValue.h>
#include <gdcmDataElement.h>
#include <gdcmFragment.h>
#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>

#include <cstdint>

namespace {

using gonio::io::DicomPixels;

gdcm::TransferSyntax gdcm_syntax(DicomPixels pixels) {
  switch (pixels) {
    case DicomPixels::jpeg_ls: return gdcm::TransferSyntax::JPEGLSLossless;
    case DicomPixels::jpeg_2000: return gdcm::TransferSyntax::JPEG2000Lossless;
    default: return gdcm::TransferSyntax::JPEGLosslessProcess14_1;
  }
}

}  // namespace

bool gonio_decode_dicom(const gonio::io::DicomFile& file, std::string_view stored, int bits, bool is_signed,
                        std::string& out) {
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
  return image.GetBufferLength() == out.size() && image.GetBuffer(out.data());
}
