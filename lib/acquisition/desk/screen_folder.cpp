// See screen_folder.h.
#include "acquisition/desk/screen_folder.h"

#include <chrono>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "io/raster_header.h"
#include "manifest/sections/laboratory.h"

namespace gonio::acquisition::desk {

namespace fs = std::filesystem;

namespace {

constexpr std::chrono::milliseconds settled{50};

// What a file with this picture in it ends in.
std::string ending_of(const std::string& picture, const fs::path& place) {
  switch (io::read_raster_header(picture, place.string()).kind) {
    case io::RasterKind::png: return ".png";
    case io::RasterKind::jpeg: return ".jpg";
    case io::RasterKind::tiff: return ".tiff";
    case io::RasterKind::bmp: return ".bmp";
    case io::RasterKind::tga: return ".tga";
  }
  return {};
}

}  // namespace

ScreenFolders::ScreenFolders(TrueState& state, fs::path folder) : state_(state), folder_(std::move(folder)) {
  for (const auto& [name, screen] : state_.section().screens) make_folder(folder_of(name));
  thread_ = std::thread([this] { serve(); });
}

ScreenFolders::~ScreenFolders() {
  ending_ = true;
  thread_.join();
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void ScreenFolders::serve() {
  while (!ending_) {
    for (const auto& [name, screen] : state_.section().screens) look_at(name);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

// The picture is kept under its hash: a client may put the next one there while a frame is rendered.
void ScreenFolders::look_at(const std::string& screen) {
  const fs::path folder = folder_of(screen);
  std::string said;
  try {
    if (!fs::exists(folder / "show")) return;
    const fs::file_time_type written = fs::last_write_time(folder / "show");
    // The clock of file systems ticks in milliseconds: what was read right after it was written is read once more.
    if (const auto before = read_.find(screen); before != read_.end() && before->second > written + settled) return;
    read_[screen] = fs::file_time_type::clock::now();
    const std::string picture = read_file(folder / "show"), hash = sha256(picture);
    said = hash;
    if (const auto before = answered_.find(screen); before != answered_.end() && before->second.starts_with(hash))
      return;
    fs::path kept;
    if (!picture.empty()) kept = folder / ("picture-" + hash + ending_of(picture, folder / "show"));
    if (!picture.empty()) write_file(kept, picture);
    const std::lock_guard lock(state_.busy);
    state_.show(screen, kept.string());
  } catch (const Error& error) {
    said += " refused: " + error.problem();
  }
  answered_[screen] = said;
  try {
    write_file(folder / "shown", said + "\n");
  } catch (const Error&) {  // nobody can be told: the client's time runs out
  }
}

}  // namespace gonio::acquisition::desk
