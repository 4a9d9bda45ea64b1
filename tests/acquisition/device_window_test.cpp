// A screen in memory (Xvfb, an X server that is not ours): what it shows is read back by another client, all pixels.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/uio.h>
#include <xcb/randr.h>
#include <xcb/xcb.h>
#include <xcb/xcbext.h>

#include <fstream>
#include <thread>

#include "acquisition/device/devices.h"
#include "acquisition/refusal_words.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "io/raster.h"
#include "process.h"

using namespace gonio;
using namespace gonio::acquisition;
using testing::HasSubstr;
using tests::words_of;

namespace {

// 200 x 100 pixels, of which 80 x 100 at the right are monitor "beamer".
class ScreenInMemory {
 public:
  ScreenInMemory() {
    const std::string said = (folder_ / "display").string();
    process_.emplace(
        tests::Process::Words{"Xvfb", "-displayfd", "9", "-screen", "0", "200x100x24", "-nolisten", "tcp", "-noreset"},
        std::filesystem::path{}, std::string{}, [said] {
          ::prctl(PR_SET_PDEATHSIG, SIGKILL);
          ::dup2(::open(said.c_str(), O_WRONLY | O_CREAT, 0600), 9);  // which the server closes
        });
    std::string number;
    for (int n = 0; n < 1000 && number.find('\n') == std::string::npos; ++n) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      if (std::filesystem::exists(said)) number = read_file(said);
    }
    if (number.empty()) return;
    display = ":" + number.substr(0, number.find('\n'));
    x_ = xcb_connect(display.c_str(), nullptr);
    if (xcb_connection_has_error(x_) != 0) throw std::runtime_error("Xvfb does not answer at " + display);
    root_ = xcb_setup_roots_iterator(xcb_get_setup(x_)).data->root;
    add_monitor("beamer", 120, 80);
    add_monitor("desk", 0, 120);
  }
  ~ScreenInMemory() {
    if (x_ != nullptr) xcb_disconnect(x_);
    end();
  }
  void end() {
    if (process_) ::kill(process_->id(), SIGTERM), process_->end();
    process_.reset();
  }
  // 0xRRGGBB, row by row.
  std::vector<std::uint32_t> pixels(int left, int width) {
    auto* image =
        xcb_get_image_reply(x_,
                            xcb_get_image(x_, XCB_IMAGE_FORMAT_Z_PIXMAP, root_, static_cast<std::int16_t>(left), 0,
                                          static_cast<std::uint16_t>(width), 100, 0xFFFFFF),
                            nullptr);
    const auto* words = reinterpret_cast<const std::uint32_t*>(xcb_get_image_data(image));
    std::vector<std::uint32_t> all(words, words + xcb_get_image_data_length(image) / 4);
    for (std::uint32_t& one : all) one &= 0xFFFFFF;
    std::free(image);
    return all;
  }
  std::string display;

 private:
  void add_monitor(const std::string& name, std::int16_t x, std::uint16_t width) {
    auto* atom = xcb_intern_atom_reply(
        x_, xcb_intern_atom(x_, 0, static_cast<std::uint16_t>(name.size()), name.c_str()), nullptr);
    // xcb_randr_set_monitor() of libxcb 1.15 sends a request of a wrong length.
    struct {
      std::uint8_t major = 0, minor = 0;
      std::uint16_t length = 0;
      std::uint32_t window = 0;
      xcb_randr_monitor_info_t monitor{};
    } message;
    static_assert(sizeof message == 32);
    message.window = root_;
    message.monitor.name = atom->atom;
    message.monitor.x = x, message.monitor.width = width, message.monitor.height = 100;
    std::free(atom);
    static const xcb_protocol_request_t request{1, &xcb_randr_id, XCB_RANDR_SET_MONITOR, 1};
    iovec parts[3]{};  // two are libxcb's own
    parts[2] = {&message, sizeof message};
    const xcb_void_cookie_t asked{xcb_send_request(x_, XCB_REQUEST_CHECKED, parts + 2, &request)};
    if (auto* wrong = xcb_request_check(x_, asked); wrong != nullptr) {
      ADD_FAILURE() << "no monitor " << name << ": error " << int{wrong->error_code};
      std::free(wrong);
    }
  }
  tests::ScratchFolder folder_;
  std::optional<tests::Process> process_;
  xcb_connection_t* x_ = nullptr;
  xcb_window_t root_ = 0;
};

io::Image noise_picture(int width, int height, const std::vector<std::string>& channels, std::uint64_t seed) {
  io::Image image(width, height, channels);
  Random random(seed);
  for (float& value : image.data) value = static_cast<float>(random.below(256)) / 255;
  return image;
}
std::uint32_t shown_code(const io::Image& image, std::size_t i) {
  const std::size_t channels = image.channels.size();
  std::uint32_t code = 0;
  for (std::size_t c = 0; c < 3; ++c)
    code = code << 8 | static_cast<std::uint32_t>(std::lround(image.data[i * channels + (channels < 3 ? 0 : c)] * 255));
  return code;
}

bool has_xvfb() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((folder + "/Xvfb").c_str(), X_OK) == 0) return true;
  return false;
}

TEST(WindowScreen, ShowsEveryPixelAsItIs) {
  if (!has_xvfb()) GTEST_SKIP() << "Xvfb (Debian's package xvfb) is missing: nothing to show a picture on";
  ScreenInMemory screen;
  ASSERT_NE(screen.display, "");
  const tests::ScratchFolder folder;
  const std::string query = "?display=" + screen.display;
  const auto beamer = open_screen("window://beamer" + query, "here");
  const auto desk = screen.pixels(0, 120);
  int round = 0;
  for (const std::vector<std::string>& channels : {std::vector<std::string>{"R", "G", "B"}, {"Y"}, {"R", "G", "B"}}) {
    const io::Image picture = noise_picture(80, 100, channels, static_cast<std::uint64_t>(++round));
    write_file(folder / "p.png", io::encode_raster_png(picture));
    beamer->show((folder / "p.png").string());
    const auto shown = screen.pixels(120, 80);
    ASSERT_EQ(shown.size(), 8000U);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < shown.size(); ++i) wrong += shown[i] != shown_code(picture, i);
    EXPECT_EQ(wrong, 0U);
    EXPECT_EQ(screen.pixels(0, 120), desk);  // the other monitor stays as it is
  }
  beamer->show("");
  EXPECT_EQ(screen.pixels(120, 80), std::vector<std::uint32_t>(8000));

  write_file(folder / "small.png", io::encode_raster_png(noise_picture(79, 100, {"Y"}, 9)));
  EXPECT_THAT(words_of([&] { beamer->show((folder / "small.png").string()); }, Exit::data),
              HasSubstr("small.png: has 79 x 100 pixels, monitor beamer has 80 x 100; nothing is scaled"));
  write_file(folder / "deep.png", io::encode_raster_png(noise_picture(80, 100, {"Y"}, 9), 16));
  EXPECT_THAT(words_of([&] { beamer->show((folder / "deep.png").string()); }, Exit::data), HasSubstr("has 16 bits"));
  EXPECT_THAT(words_of([&] { open_screen("window://HDMI-1" + query, "lab.json"); }, Exit::unavailable),
              testing::AllOf(HasSubstr("lab.json: screen HDMI-1 of display " + screen.display),
                             HasSubstr("(beamer, 80 x 100)"), HasSubstr("(desk, 120 x 100)")));
  EXPECT_EQ(screen.pixels(120, 80), std::vector<std::uint32_t>(8000));  // what was refused shows nothing
}

TEST(WindowScreen, AServerThatIsNotThereIsSaid) {
  EXPECT_THAT(words_of([] { open_screen("window://0?display=:64999", "here"); }, Exit::unavailable),
              HasSubstr("here: screen 0 of display :64999: no X server answers there"));
  EXPECT_THAT(words_of([] { open_screen("window://", "here"); }, Exit::usage), HasSubstr("names no monitor"));
  if (!has_xvfb()) GTEST_SKIP() << "Xvfb (Debian's package xvfb) is missing: none can go away";
  ScreenInMemory screen;
  const auto desk = open_screen("window://desk?display=" + screen.display, "here");
  desk->show("");
  screen.end();
  EXPECT_THAT(words_of([&] { desk->show(""); }, Exit::unavailable), HasSubstr("the X server went away"));
}

}  // namespace
