// window://MONITOR: a monitor or projector that shows a picture pixel for pixel, in a window of its own that fills it
// and that no window manager touches. The X server draws the picture by itself from then on (it is the window's
// background); show() returns once what the server has on that part of the screen is the picture.
#include <xcb/randr.h>
#include <xcb/xcb.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <thread>

#include "acquisition/device/connection.h"
#include "acquisition/device/url_query.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "io/raster.h"
#include "io/raster_header.h"

namespace gonio::acquisition::drivers {
namespace {

using Codes = std::vector<std::uint32_t>;  // 0xRRGGBB, row by row

template <class Reply>
using XReply = std::unique_ptr<Reply, decltype([](void* reply) { std::free(reply); })>;

struct Monitor {
  std::string name;
  std::int16_t x = 0, y = 0;
  std::uint16_t width = 0, height = 0;
};

// A connection to an X server whose pixels are eight bits of red, green and blue.
class XServer {
 public:
  explicit XServer(const std::string& display) {
    int number = 0;
    x_.reset(xcb_connect(display.empty() ? nullptr : display.c_str(), &number));
    if (xcb_connection_has_error(x_.get()) != 0) throw Lost("no X server answers there");
    auto screens = xcb_setup_roots_iterator(xcb_get_setup(x_.get()));
    for (; number > 0 && screens.rem > 1; --number) xcb_screen_next(&screens);
    screen_ = screens.data;
    const xcb_visualtype_t* visual = root_visual();
    const bool eights = visual != nullptr && visual->_class == XCB_VISUAL_CLASS_TRUE_COLOR &&
                        std::popcount(visual->red_mask) == 8 && std::popcount(visual->green_mask) == 8 &&
                        std::popcount(visual->blue_mask) == 8;
    if (!eights || bits_per_pixel() != 32 ||
        (xcb_get_setup(x_.get())->image_byte_order == XCB_IMAGE_ORDER_LSB_FIRST) !=
            (std::endian::native == std::endian::little))
      throw Lost(format("its screen has %d bits a pixel, not eight each of red, green and blue", screen_->root_depth));
    red_ = std::countr_zero(visual->red_mask);
    green_ = std::countr_zero(visual->green_mask);
    blue_ = std::countr_zero(visual->blue_mask);
  }

  xcb_connection_t* x() const { return x_.get(); }
  const xcb_screen_t& screen() const { return *screen_; }
  void check() const {
    if (xcb_connection_has_error(x_.get()) != 0) throw Lost("the X server went away");
  }
  // Waits until the server has done all that was asked.
  void settle() const {
    const XReply<xcb_get_input_focus_reply_t> done(
        xcb_get_input_focus_reply(x_.get(), xcb_get_input_focus(x_.get()), nullptr));
    check();
  }

  std::vector<Monitor> monitors() const {
    std::vector<Monitor> all;
    const XReply<xcb_randr_query_version_reply_t> version(
        xcb_randr_query_version_reply(x_.get(), xcb_randr_query_version(x_.get(), 1, 5), nullptr));
    if (!version || (version->major_version == 1 && version->minor_version < 5))
      throw Lost("its X server does not list monitors (RandR 1.5)");
    const XReply<xcb_randr_get_monitors_reply_t> listed(
        xcb_randr_get_monitors_reply(x_.get(), xcb_randr_get_monitors(x_.get(), screen_->root, 1), nullptr));
    check();
    if (!listed) return all;
    for (auto one = xcb_randr_get_monitors_monitors_iterator(listed.get()); one.rem > 0;
         xcb_randr_monitor_info_next(&one))
      all.push_back({name_of(one.data->name), one.data->x, one.data->y, one.data->width, one.data->height});
    return all;
  }

  void put(xcb_drawable_t to, const Codes& codes, std::uint16_t width, std::uint16_t height) const {
    const xcb_gcontext_t pen = xcb_generate_id(x_.get());
    xcb_create_gc(x_.get(), pen, to, 0, nullptr);
    Codes shifted;
    for (const std::uint32_t code : codes)
      shifted.push_back((code >> 16 & 255) << red_ | (code >> 8 & 255) << green_ | (code & 255) << blue_);
    for (std::uint16_t y = 0; y < height; y = static_cast<std::uint16_t>(y + strip(width))) {
      const auto rows = std::min<std::uint16_t>(strip(width), static_cast<std::uint16_t>(height - y));
      xcb_put_image(x_.get(), XCB_IMAGE_FORMAT_Z_PIXMAP, to, pen, width, rows, 0, static_cast<std::int16_t>(y), 0,
                    screen_->root_depth, std::uint32_t{4} * width * rows,
                    reinterpret_cast<const std::uint8_t*>(shifted.data() + std::size_t{y} * width));
    }
    xcb_free_gc(x_.get(), pen);
  }

  // What is on the screen there, whoever drew it.
  Codes seen(const Monitor& at) const {
    Codes codes;
    for (std::uint16_t y = 0; y < at.height; y = static_cast<std::uint16_t>(y + strip(at.width))) {
      const auto rows = std::min<std::uint16_t>(strip(at.width), static_cast<std::uint16_t>(at.height - y));
      const XReply<xcb_get_image_reply_t> got(
          xcb_get_image_reply(x_.get(),
                              xcb_get_image(x_.get(), XCB_IMAGE_FORMAT_Z_PIXMAP, screen_->root, at.x,
                                            static_cast<std::int16_t>(at.y + y), at.width, rows, ~0U),
                              nullptr));
      check();
      if (!got) throw Lost("the X server does not say what its screen shows");
      const auto* words = reinterpret_cast<const std::uint32_t*>(xcb_get_image_data(got.get()));
      for (int i = 0, count = xcb_get_image_data_length(got.get()) / 4; i < count; ++i)
        codes.push_back((words[i] >> red_ & 255) << 16 | (words[i] >> green_ & 255) << 8 | (words[i] >> blue_ & 255));
    }
    return codes;
  }

 private:
  // Rows of which one request holds all.
  std::uint16_t strip(std::uint16_t width) const {
    const std::uint32_t words = std::min<std::uint32_t>(xcb_get_maximum_request_length(x_.get()), 1U << 20U) - 64;
    return static_cast<std::uint16_t>(std::clamp<std::uint32_t>(words / width, 1, 65535));
  }
  const xcb_visualtype_t* root_visual() const {
    for (auto depth = xcb_screen_allowed_depths_iterator(screen_); depth.rem > 0; xcb_depth_next(&depth))
      for (auto visual = xcb_depth_visuals_iterator(depth.data); visual.rem > 0; xcb_visualtype_next(&visual))
        if (visual.data->visual_id == screen_->root_visual) return visual.data;
    return nullptr;
  }
  int bits_per_pixel() const {
    for (auto one = xcb_setup_pixmap_formats_iterator(xcb_get_setup(x_.get())); one.rem > 0; xcb_format_next(&one))
      if (one.data->depth == screen_->root_depth) return one.data->bits_per_pixel;
    return 0;
  }
  std::string name_of(xcb_atom_t atom) const {
    const XReply<xcb_get_atom_name_reply_t> name(
        xcb_get_atom_name_reply(x_.get(), xcb_get_atom_name(x_.get(), atom), nullptr));
    if (!name) return {};
    return {xcb_get_atom_name_name(name.get()), static_cast<std::size_t>(xcb_get_atom_name_name_length(name.get()))};
  }

  std::unique_ptr<xcb_connection_t, decltype([](xcb_connection_t* c) { xcb_disconnect(c); })> x_;
  const xcb_screen_t* screen_ = nullptr;
  int red_ = 16, green_ = 8, blue_ = 0;
};

struct WindowSettings {
  std::string monitor, display;  // display empty: that of the environment
  double timeout_s = 2;
};

class WindowScreen : public ScreenDevice {
 public:
  WindowScreen(WindowSettings settings, std::string place) : settings_(std::move(settings)), place_(std::move(place)) {
    or_say([this] {
      server_.emplace(settings_.display);
      choose_monitor();
      open_window();
    });
  }

  void show(const std::string& picture_path) override {
    const Codes codes =
        picture_path.empty() ? Codes(std::size_t{monitor_.width} * monitor_.height) : read(picture_path);
    or_say([&] {
      xcb_connection_t* const x = server_->x();
      const xcb_pixmap_t pixmap = xcb_generate_id(x);
      xcb_create_pixmap(x, server_->screen().root_depth, pixmap, window_, monitor_.width, monitor_.height);
      server_->put(pixmap, codes, monitor_.width, monitor_.height);
      xcb_change_window_attributes(x, window_, XCB_CW_BACK_PIXMAP, &pixmap);
      xcb_free_pixmap(x, pixmap);  // the window keeps it
      xcb_clear_area(x, 0, window_, 0, 0, 0, 0);
      const std::uint32_t above = XCB_STACK_MODE_ABOVE;
      xcb_configure_window(x, window_, XCB_CONFIG_WINDOW_STACK_MODE, &above);
      xcb_force_screen_saver(x, XCB_SCREEN_SAVER_RESET);
      server_->settle();
      for (const auto until = after(settings_.timeout_s); server_->seen(monitor_) != codes;) {
        if (Clock::now() > until) throw Lost("shows something else than the picture: does another window lie over it?");
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    });
  }

 private:
  template <class Work>
  void or_say(const Work& work) {
    try {
      work();
    } catch (const Lost& lost) {
      const char* const usual = std::getenv("DISPLAY");
      const std::string display = !settings_.display.empty() ? settings_.display : usual != nullptr ? usual : "(none)";
      throw Error(Exit::unavailable, place_,
                  "screen " + settings_.monitor + " of display " + display + ": " + lost.what(),
                  "display=:0 names the X server; xrandr --listmonitors its monitors");
    }
  }

  void choose_monitor() {
    const auto all = server_->monitors();
    std::string names;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Monitor& one = all[i];
      names += (names.empty() ? "" : ", ") + format("%zu (%s, %d x %d)", i, one.name.c_str(), one.width, one.height);
      if (one.name == settings_.monitor || std::to_string(i) == settings_.monitor) monitor_ = one;
    }
    if (monitor_.width == 0) throw Lost("there is no such monitor; there are " + (names.empty() ? "none" : names));
  }

  void open_window() {
    xcb_connection_t* const x = server_->x();
    const xcb_pixmap_t dot = xcb_generate_id(x);
    xcb_create_pixmap(x, 1, dot, server_->screen().root, 1, 1);
    const xcb_gcontext_t pen = xcb_generate_id(x);
    xcb_create_gc(x, pen, dot, 0, nullptr);
    const xcb_rectangle_t all{0, 0, 1, 1};
    const std::uint32_t nothing = 0;
    xcb_change_gc(x, pen, XCB_GC_FOREGROUND, &nothing);
    xcb_poly_fill_rectangle(x, dot, pen, 1, &all);
    const xcb_cursor_t no_pointer = xcb_generate_id(x);
    xcb_create_cursor(x, no_pointer, dot, dot, 0, 0, 0, 0, 0, 0, 0, 0);
    window_ = xcb_generate_id(x);
    const std::uint32_t values[] = {server_->screen().black_pixel, 1, no_pointer};  // in the order of their masks
    xcb_create_window(x, XCB_COPY_FROM_PARENT, window_, server_->screen().root, monitor_.x, monitor_.y, monitor_.width,
                      monitor_.height, 0, XCB_WINDOW_CLASS_INPUT_OUTPUT, server_->screen().root_visual,
                      XCB_CW_BACK_PIXEL | XCB_CW_OVERRIDE_REDIRECT | XCB_CW_CURSOR, values);
    xcb_map_window(x, window_);
    server_->settle();
  }

  Codes read(const std::string& path) const {
    const std::string bytes = read_file(path);
    const auto head = io::read_raster_header(bytes, path);
    if (head.width != monitor_.width || head.height != monitor_.height)
      throw Error(
          Exit::data, path,
          format("has %llu x %llu pixels, monitor %s has %d x %d", static_cast<unsigned long long>(head.width),
                 static_cast<unsigned long long>(head.height), monitor_.name.c_str(), monitor_.width, monitor_.height),
          "nothing is scaled: make the picture as large as the monitor");
    if (head.code_bits != 8)
      throw Error(Exit::data, path, format("has %d bits a channel, the screen has 8", head.code_bits), "write 8 bits");
    const io::Image image = io::decode_raster(bytes, path);
    Codes codes;
    const std::size_t channels = image.channels.size();
    for (std::size_t i = 0; i < image.pixels(); ++i) {
      std::uint32_t code = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = image.data[i * channels + (channels < 3 ? 0 : c)];
        code = code << 8 | static_cast<std::uint32_t>(std::lround(static_cast<double>(value) * 255));
      }
      codes.push_back(code);
    }
    return codes;
  }

  WindowSettings settings_;
  std::string place_;
  std::optional<XServer> server_;
  Monitor monitor_;
  xcb_window_t window_ = 0;
};

std::unique_ptr<ScreenDevice> window_screen(const Url& url, const std::string& place) {
  if (url.host.empty() || url.port || (!url.path.empty() && url.path != "/"))
    throw Error(Exit::usage, place, url.text + ": names no monitor",
                "write window://MONITOR, its name or number as xrandr --listmonitors says them");
  UrlQuery query(url, place);
  WindowSettings settings;
  settings.monitor = url.host;
  settings.display = query.text("display");
  settings.timeout_s = query.timeout(settings.timeout_s);
  query.end();
  return std::make_unique<WindowScreen>(std::move(settings), place);
}

}  // namespace

const Driver& window() {
  static const Driver its_driver = [] {
    Driver driver;
    driver.scheme = "window";
    driver.sentence =
        "window://MONITOR is a monitor or projector of an X server, by the name or number that xrandr --listmonitors "
        "says (display=:0, timeout=2s): a window that fills it shows 8-bit PNG, TIFF or JPEG of just its size, pixel "
        "for pixel, and goes on once the server's screen holds them; switch colour corrections off.";
    driver.screen = window_screen;
    return driver;
  }();
  return its_driver;
}

}  // namespace gonio::acquisition::drivers
