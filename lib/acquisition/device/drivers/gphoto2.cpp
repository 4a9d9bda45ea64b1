// gphoto2://MODEL: cameras that people hold in their hands, through libgphoto2.
#include <gphoto2/gphoto2.h>

#include <algorithm>
#include <memory>

#include "acquisition/device/connection.h"
#include "acquisition/device/tethered_camera.h"
#include "acquisition/device/unpack.h"
#include "acquisition/device/url_query.h"
#include "base/error.h"
#include "base/text.h"
#include "io/camera_raw.h"

namespace gonio::acquisition::drivers {
namespace {

template <class Object, auto free>
using Gphoto = std::unique_ptr<Object, decltype([](Object* object) { free(object); })>;

// Words of the library on one line, or of its error number.
struct GphotoTrouble {
  std::string words;
  static void note(GPContext*, const char* text, void* self) {
    std::string line = text;
    std::ranges::replace(line, '\n', ' ');
    static_cast<GphotoTrouble*>(self)->words = line;
  }
  int check(int answer, const std::string& what) const {
    if (answer >= GP_OK) return answer;
    throw Lost(what + ": " + (words.empty() ? gp_result_as_string(answer) : words));
  }
};

class GphotoCable : public CameraCable {
 public:
  // The one that is found there, where `model` and `port` leave but one.
  GphotoCable(const std::string& model, const std::string& port) : context_(gp_context_new()) {
    gp_context_set_error_func(context_.get(), GphotoTrouble::note, &trouble_);
    Camera* made = nullptr;
    check(gp_camera_new(&made), "libgphoto2");
    camera_.reset(made);
    choose_camera(model, port);
    check(gp_camera_init(camera_.get(), context_.get()), "opening it");
  }
  ~GphotoCable() override { gp_camera_exit(camera_.get(), context_.get()); }

  std::string identity() override {
    CameraAbilities abilities{};
    check(gp_camera_get_abilities(camera_.get(), &abilities), "its name");
    std::string text = abilities.model;
    if (const auto serial = value("serialnumber")) text += " " + *serial;
    return text;
  }

  std::optional<std::string> value(const std::string& setting) override {
    const Widget widget = widget_of(setting);
    if (!widget) return {};
    const char* text = nullptr;
    if (!is_words(widget.get()) || gp_widget_get_value(widget.get(), &text) < GP_OK || text == nullptr) return {};
    return text;
  }

  std::vector<std::string> choices(const std::string& setting) override {
    const Widget widget = widget_of(setting);
    std::vector<std::string> all;
    int fixed = 0;
    if (!widget || !is_words(widget.get()) || gp_widget_get_readonly(widget.get(), &fixed) < GP_OK || fixed != 0)
      return all;
    for (int i = 0, count = gp_widget_count_choices(widget.get()); i < count; ++i) {
      const char* text = nullptr;
      if (gp_widget_get_choice(widget.get(), i, &text) >= GP_OK && text != nullptr) all.emplace_back(text);
    }
    return all;
  }

  void choose(const std::string& setting, const std::string& choice) override {
    const Widget widget = widget_of(setting);
    if (!widget) throw Lost("has no " + setting + " any more");
    check(gp_widget_set_value(widget.get(), choice.c_str()), setting);
    check(gp_camera_set_single_config(camera_.get(), setting.c_str(), widget.get(), context_.get()),
          setting + " " + choice);
  }

  void forget_files() override {
    for (int events = 0; events < 1000 && next_event(0.001) != GP_EVENT_TIMEOUT; ++events) continue;
    added_.clear();
  }

  std::vector<File> shoot(double patience_s) override {
    added_.clear();
    const auto until = after(patience_s);
    CameraFilePath first{};
    check(gp_camera_capture(camera_.get(), GP_CAPTURE_IMAGE, &first, context_.get()), "the shutter");
    added_.push_back(first);
    const auto raw = [](const CameraFilePath& path) { return io::is_camera_raw(path.name); };
    while (std::ranges::none_of(added_, raw) && Clock::now() < until) next_event(0.2);
    while (next_event(0.05) == GP_EVENT_FILE_ADDED && Clock::now() < until) continue;  // its JPEG
    std::vector<File> files;
    for (const CameraFilePath& path : added_) files.push_back(fetched(path));
    return files;
  }

 private:
  using Widget = Gphoto<CameraWidget, gp_widget_free>;
  int check(int answer, const std::string& what) const { return trouble_.check(answer, what); }

  static bool is_words(CameraWidget* widget) {
    CameraWidgetType type{};
    return gp_widget_get_type(widget, &type) >= GP_OK &&
           (type == GP_WIDGET_RADIO || type == GP_WIDGET_MENU || type == GP_WIDGET_TEXT);
  }

  // Null: it has none of that name.
  Widget widget_of(const std::string& setting) {
    CameraWidget* found = nullptr;
    const int answer = gp_camera_get_single_config(camera_.get(), setting.c_str(), &found, context_.get());
    if (answer == GP_ERROR_BAD_PARAMETERS || answer == GP_ERROR_NOT_SUPPORTED) return {};
    check(answer, setting);
    return Widget(found);
  }

  void choose_camera(const std::string& model, const std::string& port) {
    CameraAbilitiesList* abilities_made = nullptr;
    check(gp_abilities_list_new(&abilities_made), "libgphoto2");
    const Gphoto<CameraAbilitiesList, gp_abilities_list_free> abilities(abilities_made);
    check(gp_abilities_list_load(abilities.get(), context_.get()), "libgphoto2's cameras");
    GPPortInfoList* ports_made = nullptr;
    check(gp_port_info_list_new(&ports_made), "libgphoto2");
    const Gphoto<GPPortInfoList, gp_port_info_list_free> ports(ports_made);
    check(gp_port_info_list_load(ports.get()), "libgphoto2's ports");
    const auto [name, at] = found_camera(abilities.get(), ports.get(), model, port);
    const int index = check(gp_abilities_list_lookup_model(abilities.get(), name.c_str()), name);
    CameraAbilities chosen{};
    check(gp_abilities_list_get_abilities(abilities.get(), index, &chosen), name);
    check(gp_camera_set_abilities(camera_.get(), chosen), name);
    GPPortInfo where{};
    check(gp_port_info_list_get_info(ports.get(), check(gp_port_info_list_lookup_path(ports.get(), at.c_str()), at),
                                     &where),
          at);
    check(gp_camera_set_port_info(camera_.get(), where), at);
  }

  // Its model and port. Ports that nothing can be found on (ptpip:, serial:) are believed with the model that is given.
  std::pair<std::string, std::string> found_camera(CameraAbilitiesList* abilities, GPPortInfoList* ports,
                                                   const std::string& model, const std::string& port) {
    if (!model.empty() && !port.empty() && !port.starts_with("usb:")) return {model, port};
    CameraList* list_made = nullptr;
    check(gp_list_new(&list_made), "libgphoto2");
    const Gphoto<CameraList, gp_list_free> list(list_made);
    check(gp_abilities_list_detect(abilities, ports, list.get(), context_.get()), "looking for cameras");
    std::vector<std::pair<std::string, std::string>> fitting;
    std::string all;
    for (int i = 0, count = gp_list_count(list.get()); i < count; ++i) {
      const char *name = nullptr, *at = nullptr;
      gp_list_get_name(list.get(), i, &name);
      gp_list_get_value(list.get(), i, &at);
      all += (all.empty() ? "" : ", ") + std::string(name) + " at " + at;
      if (std::string(name).find(model) != std::string::npos && (port.empty() || port == at))
        fitting.emplace_back(name, at);
    }
    if (fitting.size() == 1) return fitting.front();
    throw Lost(fitting.empty() ? (all.empty() ? "there is none" : "there is none, but " + all)
                               : "there are " + all + ": add port=");
  }

  CameraEventType next_event(double seconds) {
    CameraEventType type{};
    void* data = nullptr;
    check(gp_camera_wait_for_event(camera_.get(), static_cast<int>(1000 * seconds), &type, &data, context_.get()),
          "waiting");
    const std::unique_ptr<void, decltype([](void* memory) { std::free(memory); })> owned(data);
    if (type == GP_EVENT_FILE_ADDED && data != nullptr) {
      const auto& path = *static_cast<const CameraFilePath*>(data);
      const auto same = [&path](const CameraFilePath& other) {
        return std::string(other.folder) == path.folder && std::string(other.name) == path.name;
      };
      if (std::ranges::none_of(added_, same)) added_.push_back(path);
    }
    return type;
  }

  File fetched(const CameraFilePath& path) {
    CameraFile* made = nullptr;
    check(gp_file_new(&made), "libgphoto2");
    const Gphoto<CameraFile, gp_file_unref> file(made);
    check(gp_camera_file_get(camera_.get(), path.folder, path.name, GP_FILE_TYPE_NORMAL, file.get(), context_.get()),
          path.name);
    const char* bytes = nullptr;
    unsigned long size = 0;
    check(gp_file_get_data_and_size(file.get(), &bytes, &size), path.name);
    File fetched{path.name, {bytes, size}};
    gp_camera_file_delete(camera_.get(), path.folder, path.name,
                          context_.get());  // from its memory; some do it themselves
    return fetched;
  }

  GphotoTrouble trouble_;
  Gphoto<GPContext, gp_context_unref> context_;
  Gphoto<Camera, gp_camera_unref> camera_;
  std::vector<CameraFilePath> added_;
};

std::unique_ptr<CameraDevice> gphoto_camera(const Url& url, const std::string& place) {
  if (url.port || (!url.path.empty() && url.path != "/"))
    throw Error(Exit::usage, place, url.text + ": names no camera", "write gphoto2://MODEL, blanks as %20");
  UrlQuery query(url, place);
  TetherSettings settings;
  const std::string port = query.text("port");
  settings.name = url.host.empty() ? port.empty() ? "(any)" : port : url.host;
  settings.pixel_format = query.text("pixel_format");
  if (!settings.pixel_format.empty() && !parse_pixel_format(settings.pixel_format))
    throw Error(Exit::usage, place, url.text + ": pixel_format is '" + settings.pixel_format + "'",
                "as BayerRG12, BayerRG14");
  settings.quality = query.text("quality");
  settings.base_iso = query.quantity("iso", Dimension::none, settings.base_iso, 1, 1e6);
  settings.timeout_s = query.timeout(settings.timeout_s);
  query.end();
  const std::string model = url.host;
  return make_tethered_camera(
      std::move(settings), [model, port] { return std::make_unique<GphotoCable>(model, port); }, place);
}

}  // namespace

const Driver& gphoto2() {
  static const Driver its_driver = [] {
    Driver driver;
    driver.scheme = "gphoto2";
    driver.sentence =
        "gphoto2://MODEL is a camera that writes raw files, by what its name has in it (blanks as %20; nothing: the "
        "only one that is connected), through libgphoto2 (port=usb:001,004; quality= the choice that writes raw files; "
        "iso=100, whose gain is 0 dB; pixel_format=BayerRG14, what the files hold; timeout=30s beyond the exposure); "
        "exposures and gains are those of its lists, read back, and then out of the file itself.";
    driver.camera = gphoto_camera;
    driver.camera_keys = {"pixel_format"};
    return driver;
  }();
  return its_driver;
}

}  // namespace gonio::acquisition::drivers
