// folder:///DIR: pictures that another program writes. The next picture that appears after the call, complete: its size
// has not changed for a while and it can be decoded. PNG and TIFF do not say how they were exposed; raw files of
// cameras do. Where two appear at once nobody knows which of them was asked for. And a screen whose pictures another
// program shows: they lie in DIR/show, and DIR/shown says which one it is by its SHA-256.
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <thread>

#include "acquisition/device/connection.h"
#include "acquisition/device/raw_file.h"
#include "acquisition/device/unpack.h"
#include "acquisition/device/url_query.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/lower_case.h"
#include "base/text.h"
#include "io/camera_raw.h"
#include "io/raster.h"
#include "io/raster_header.h"

namespace gonio::acquisition::drivers {
namespace {

namespace fs = std::filesystem;

struct FolderSettings {
  fs::path folder;
  std::string pixel_format;  // empty: as the file says
  std::optional<double> base_iso;
  double timeout_s = 10, settle_s = 0.2;
};

bool may_be_picture(const fs::path& path) {
  const std::string extension = lower_case(path.extension().string());
  return path.filename().string()[0] != '.' &&
         (extension == ".png" || extension == ".tif" || extension == ".tiff" || io::is_camera_raw(path));
}

class FolderCamera : public CameraDevice {
 public:
  FolderCamera(FolderSettings settings, std::string place) : settings_(std::move(settings)), place_(std::move(place)) {
    pictures();
  }
  std::string identity() override {
    pictures();
    return "files in " + settings_.folder.string();
  }

  RawFrame take(const Shot& shot) override {
    const std::set<std::string> before = pictures();  // exposed before the call
    const auto until = after(shot.exposure_s + settings_.timeout_s);
    std::map<std::string, Growth> growing;
    std::string trouble;
    for (;;) {
      std::vector<std::string> complete;
      const auto now = Clock::now();
      bool any_grows = false;
      for (const std::string& name : pictures()) {
        if (before.count(name) != 0) continue;
        if (has_settled(growing[name], settings_.folder / name, now))
          complete.push_back(name);
        else
          any_grows = true;
      }
      if (complete.size() > 1)
        throw failure("holds " + complete[0] + " and " + complete[1] + " after one call",
                      "one picture a call, in one format");
      if (complete.size() == 1 && !any_grows) {
        try {
          return frame_of(complete[0]);
        } catch (const Error& error) {
          trouble = ", " + complete[0] + " " + error.problem();
        }
      }
      if (now > until)
        throw failure(format("no new picture within %.3g s", shot.exposure_s + settings_.timeout_s) + trouble,
                      "does the other program write PNG, TIFF or raw files there, under a new name for each?");
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

 private:
  struct Growth {
    std::uintmax_t size = 0;
    fs::file_time_type written{};
    Clock::time_point since{};
  };

  Error failure(const std::string& problem, const std::string& remedy) const {
    return Error(Exit::unavailable, place_, "folder " + settings_.folder.string() + ": " + problem, remedy);
  }

  std::set<std::string> pictures() const {
    std::set<std::string> names;
    std::error_code wrong;
    for (fs::directory_iterator entry(settings_.folder, wrong), end; !wrong && entry != end; entry.increment(wrong))
      if (may_be_picture(entry->path())) names.insert(entry->path().filename().string());
    if (wrong) throw failure(wrong.message(), "make the folder, or name another");
    return names;
  }

  bool has_settled(Growth& growth, const fs::path& path, Clock::time_point now) const {
    std::error_code wrong;
    const auto size = fs::file_size(path, wrong);
    const auto written = fs::last_write_time(path, wrong);
    if (wrong || size == 0 || size != growth.size || written != growth.written) {
      growth = {wrong ? 0 : size, wrong ? fs::file_time_type{} : written, now};
      return false;
    }
    return now - growth.since >= std::chrono::duration<double>(settings_.settle_s);
  }

  RawFrame frame_of(const std::string& name) {
    const std::string path = (settings_.folder / name).string(), bytes = read_file(path);
    if (io::is_camera_raw(path)) {
      RawFrame frame = frame_of_raw_file(bytes, path, settings_.pixel_format, settings_.base_iso);
      frame.frame_id = ++count_;
      return frame;
    }
    const int stored_bits = io::read_raster_header(bytes, path).code_bits;
    const io::Image image = io::decode_raster(bytes, path);
    if (image.channels.size() != 1)
      throw Error(Exit::data, path, "has colours: it is not as the sensor saw it",
                  "write one channel, before demosaicing");
    const auto said = parse_pixel_format(settings_.pixel_format);
    const int bits = said ? said->bits : stored_bits;
    if (bits > stored_bits)
      throw Error(Exit::data, path, format("has %d bits, pixel_format says %d", stored_bits, bits), "write 16 bits");
    RawFrame frame;
    frame.width_px = image.width;
    frame.height_px = image.height;
    frame.bits = bits;
    frame.pixel_format = said ? said->unpacked() : stored_bits == 8 ? "Mono8" : "Mono16";
    frame.samples.reserve(image.data.size());
    // A float holds all of 65,536 codes: this gives back what was stored.
    const double full_scale = stored_bits == 8 ? 255 : 65535;
    for (const float value : image.data)
      frame.samples.push_back(static_cast<std::uint16_t>(std::lround(static_cast<double>(value) * full_scale)));
    for (const std::uint16_t sample : frame.samples)
      if (sample >> static_cast<unsigned>(bits) != 0)
        throw Error(Exit::data, path, format("holds %d, more than %d bits", sample, bits),
                    "pixel_format= with 16 bits");
    frame.frame_id = ++count_;
    return frame;
  }

  FolderSettings settings_;
  std::string place_;
  std::uint64_t count_ = 0;
};

std::unique_ptr<CameraDevice> folder_camera(const Url& url, const std::string& place) {
  if (!url.host.empty() || url.path.size() < 2)
    throw Error(Exit::usage, place, url.text + ": names no folder", "write folder:///DIR, with three strokes");
  UrlQuery query(url, place);
  FolderSettings settings;
  settings.folder = url.path;
  settings.pixel_format = query.text("pixel_format");
  if (!settings.pixel_format.empty() && !parse_pixel_format(settings.pixel_format))
    throw Error(Exit::usage, place, url.text + ": pixel_format is '" + settings.pixel_format + "'",
                "as Mono12, BayerRG8, Polarized16");
  if (const double iso = query.quantity("iso", Dimension::none, 0, 1, 1e6); iso > 0) settings.base_iso = iso;
  settings.settle_s = query.quantity("settle", Dimension::time, settings.settle_s, 1e-3, 3600);
  settings.timeout_s = query.timeout(settings.timeout_s);
  query.end();
  return std::make_unique<FolderCamera>(std::move(settings), place);
}

class FolderScreen : public ScreenDevice {
 public:
  FolderScreen(fs::path folder, double timeout_s, std::string place)
      : folder_(std::move(folder)), place_(std::move(place)), timeout_s_(timeout_s) {
    if (!fs::is_directory(folder_)) throw failure("is no folder", "start the program that shows the pictures");
  }
  void show(const std::string& picture_path) override {
    const std::string picture = picture_path.empty() ? "" : read_file(picture_path), hash = sha256(picture);
    write_file(folder_ / "show", picture);
    std::string said;
    for (const auto until = after(timeout_s_); !said.starts_with(hash);) {
      if (Clock::now() > until)
        throw failure(format("does not say within %.3g s that it shows the picture", timeout_s_),
                      "does the program that shows it run?");
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      if (fs::exists(folder_ / "shown")) said = read_file(folder_ / "shown");
    }
    if (const auto why = said.find(" refused: "); why != std::string::npos)
      throw failure("refuses " + picture_path + ": " + said.substr(why + 10, said.find('\n') - why - 10),
                    "another picture");
  }

 private:
  Error failure(const std::string& problem, const std::string& remedy) const {
    return Error(Exit::unavailable, place_, "screen " + folder_.string() + ": " + problem, remedy);
  }
  fs::path folder_;
  std::string place_;
  double timeout_s_;
};

std::unique_ptr<ScreenDevice> folder_screen(const Url& url, const std::string& place) {
  if (!url.host.empty() || url.path.size() < 2)
    throw Error(Exit::usage, place, url.text + ": names no folder", "write folder:///DIR, with three strokes");
  UrlQuery query(url, place);
  const double timeout_s = query.timeout(10);
  query.end();
  return std::make_unique<FolderScreen>(url.path, timeout_s, place);
}

}  // namespace

const Driver& folder() {
  static const Driver its_driver = [] {
    Driver driver;
    driver.scheme = "folder";
    driver.sentence =
        "folder:///DIR is a camera that another program works: each call waits for the next new PNG or TIFF of one "
        "channel, or raw file of a camera, there (pixel_format=BayerRG12 says what it holds, settle=200ms how long its "
        "size must stand, timeout=10s beyond the exposure, iso=100 whose gain is 0 dB); a raw file says how it was "
        "exposed, of the others nothing is read back, so nothing checks them; or a screen that another program works: "
        "it shows what "
        "lies in DIR/show, black where that is empty, and writes the picture's SHA-256 to DIR/shown.";
    driver.camera = folder_camera;
    driver.screen = folder_screen;
    driver.camera_keys = {"pixel_format"};
    return driver;
  }();
  return its_driver;
}

}  // namespace gonio::acquisition::drivers
