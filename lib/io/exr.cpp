// OpenEXR pictures from and to memory, so that reading is bounded by the file's own length and writing is one atomic
// step. What it does not do: deep pixels, subsampled channels, parts beyond the first, windows other than the whole
// picture.
#include "io/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <mutex>

#include "base/error.h"
#include "base/parallel.h"
#include "io/little_endian.h"
#include "io/raster_header.h"

namespace gonio::io {
namespace {

constexpr int longest_side_px = 1 << 17;

class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(const std::string& bytes) : Imf::IStream("memory"), bytes_(bytes) {}
  bool read(char buffer[], int count) override {
    const auto wanted = static_cast<std::uint64_t>(std::max(count, 0));
    if (position_ > bytes_.size() || wanted > bytes_.size() - position_)
      throw std::runtime_error("the file ends too early");
    std::memcpy(buffer, bytes_.data() + position_, wanted);
    position_ += wanted;
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

 private:
  const std::string& bytes_;
  std::uint64_t position_ = 0;
};

class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : Imf::OStream("memory") {}
  void write(const char buffer[], int count) override {
    const auto length = static_cast<std::size_t>(count);
    if (position_ + length > bytes.size()) bytes.resize(position_ + length);
    std::memcpy(bytes.data() + position_, buffer, length);
    position_ += length;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }
  std::string bytes;

 private:
  std::size_t position_ = 0;
};

// Alphabetical as in the file, with a plain R, G, B first in this order.
std::vector<std::string> ordered_channels(const Imf::ChannelList& list) {
  std::vector<std::string> names;
  for (auto c = list.begin(); c != list.end(); ++c) names.emplace_back(c.name());
  const auto has = [&](const char* name) { return list.findChannel(name) != nullptr; };
  if (!has("R") || !has("G") || !has("B")) return names;
  const auto rank = [](const std::string& name) { return name == "R" ? 0 : name == "G" ? 1 : name == "B" ? 2 : 3; };
  std::stable_sort(names.begin(), names.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  return names;
}

void check_header(const Imf::Header& header, std::uint64_t file_bytes, const std::string& place) {
  const auto& window = header.dataWindow();
  if (window != header.displayWindow())
    throw Error(Exit::data, place, "the data window is not the display window",
                "export the whole picture without a crop");
  std::uint64_t pixel_bytes = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    pixel_bytes += sizeof(float);
    if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
      throw Error(Exit::data, place, "channel " + std::string(c.name()) + " is subsampled", "export R, G, B instead");
  }
  if (pixel_bytes == 0) throw Error(Exit::data, place, "the picture has no channels");
  const auto side = [](int first, int last) { return static_cast<std::uint64_t>(std::int64_t{last} - first + 1); };
  check_decoded_size(side(window.min.x, window.max.x), side(window.min.y, window.max.y), pixel_bytes, file_bytes,
                     place);
}

// The library quotes names from the file, whatever bytes they are.
std::string shown(std::string what) {
  constexpr std::size_t longest = 200;
  if (what.size() > longest) what = what.substr(0, longest) + "...";
  std::replace_if(
      what.begin(), what.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return what;
}

// The library allocates what an attribute claims before it reads it. Name, type, both ended by a zero, length, value;
// an empty name ends them. What is wrong with the rest, the library says.
void check_attributes(const std::string& bytes, const std::string& place) {
  std::size_t at = 8;  // behind the signature and the version
  while (at < bytes.size() && bytes[at] != '\0') {
    const std::size_t name = bytes.find('\0', at), type = name == std::string::npos ? name : bytes.find('\0', name + 1);
    if (type == std::string::npos || bytes.size() - type < 5) return;
    const auto length = stored_at<std::int32_t>(bytes, type + 1);
    const std::size_t left = bytes.size() - type - 5;
    if (length < 0 || static_cast<std::size_t>(length) > left)
      throw Error(Exit::data, place,
                  "its head claims " + std::to_string(length) + " bytes for one entry, and " + std::to_string(left) +
                      " are left",
                  "export or copy it again");
    at = type + 5 + static_cast<std::size_t>(length);
  }
}

Image decode(const std::string& bytes, const std::string& place) {
  check_attributes(bytes, place);
  Imf::Header::setMaxImageSize(longest_side_px, longest_side_px);
  MemoryInput stream(bytes);
  Imf::InputFile file(stream, 0);
  check_header(file.header(), bytes.size(), place);
  if (!file.isComplete()) throw Error(Exit::data, place, "the file is cut off: rows are missing", "copy it again");
  const auto window = file.header().dataWindow();
  Image image(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1,
              ordered_channels(file.header().channels()));
  const std::size_t x_stride = image.channels.size() * sizeof(float);
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < image.channels.size(); ++c)
    frame.insert(image.channels[c], Imf::Slice::Make(Imf::FLOAT, image.data.data() + c, window, x_stride,
                                                     x_stride * static_cast<std::size_t>(image.width)));
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  return image;
}

// What the library throws becomes an error of the file.
template <class Read>
auto guarded(const std::string& place, const Read& read) {
  try {
    return read();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& failure) {
    throw Error(Exit::data, place, "is not a whole OpenEXR file (" + shown(failure.what()) + ")",
                "export or copy it again");
  }
}

// The library's own threads, for pictures whose compression takes long; the bytes do not depend on them.
int helpers_for(const Image& image) {
  constexpr std::size_t many = std::size_t{1} << 22;
  if (image.data.size() < many || threads() < 2) return 0;
  static std::once_flag once;
  std::call_once(once, [] { Imf::setGlobalThreadCount(threads()); });
  return Imf::globalThreadCount();
}

}  // namespace

Image decode_exr(const std::string& bytes, const std::string& place) {
  return guarded(place, [&] { return decode(bytes, place); });
}

ExrAttributes exr_attributes(const std::string& bytes, const std::string& place) {
  return guarded(place, [&] {
    check_attributes(bytes, place);
    MemoryInput stream(bytes);
    const Imf::InputFile file(stream, 0);
    ExrAttributes texts;
    for (auto a = file.header().begin(); a != file.header().end(); ++a)
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute())) texts[a.name()] = text->value();
    return texts;
  });
}

std::string encode_exr(const Image& image, const ExrAttributes& attributes) {
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const auto& [name, text] : attributes) header.insert(name, Imf::StringAttribute(text));
  const std::size_t x_stride = image.channels.size() * sizeof(float);
  const std::size_t y_stride = x_stride * static_cast<std::size_t>(image.width);
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    header.channels().insert(image.channels[c], Imf::Channel(Imf::FLOAT));
    // The frame buffer's pointer is not const, yet OutputFile only reads through it.
    auto* first = reinterpret_cast<char*>(const_cast<float*>(image.data.data() + c));
    frame.insert(image.channels[c], Imf::Slice(Imf::FLOAT, first, x_stride, y_stride));
  }
  MemoryOutput stream;
  {
    Imf::OutputFile file(stream, header, helpers_for(image));
    file.setFrameBuffer(frame);
    file.writePixels(image.height);
  }
  return std::move(stream.bytes);
}

}  // namespace gonio::io
