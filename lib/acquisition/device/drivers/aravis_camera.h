// aravis's functions with their errors as ours: what the driver of cameras is built on. Private to it.
#pragma once
#include <arv.h>

#include <algorithm>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "base/error.h"

namespace gonio::acquisition::drivers {

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};
template <class Object>
using Held = std::unique_ptr<Object, Unref>;

struct Wrong {
  GError* error = nullptr;
  ~Wrong() { g_clear_error(&error); }
};

struct GenicamSettings {
  std::string address, pixel_format, trigger;  // trigger empty: software where there is one
  int packet_size = 0;                         // 0: as the camera has it
  double timeout_s = 3;
  double readout_s = 0;     // from the exposure's end until the frame may come
  double gain_step_db = 0;  // what one of GainRaw is; 0: not known
};

// aravis's functions with their errors as ours.
class AravisCamera {
 protected:
  AravisCamera(GenicamSettings settings, std::string place)
      : settings_(std::move(settings)), place_(std::move(place)) {}
  Error failure(const std::string& problem, const std::string& remedy) const {
    return Error(Exit::unavailable, place_, "camera " + settings_.address + ": " + problem, remedy);
  }
  Error impossible(const std::string& problem, const std::string& remedy) const {
    return Error(Exit::data, place_, "camera " + settings_.address + ": " + problem, remedy);
  }

  // f(camera, arguments..., &error), one of aravis's functions.
  template <class Function, class... Arguments>
  auto ask(Function f, Arguments... arguments) {
    Wrong wrong;
    const auto check = [&] {
      if (wrong.error == nullptr) return;
      std::string words = wrong.error->message;
      std::replace(words.begin(), words.end(), '\n', ' ');
      throw failure(words, "is it on, connected, and held by no other program?");
    };
    if constexpr (std::is_void_v<decltype(f(camera_.get(), arguments..., &wrong.error))>) {
      f(camera_.get(), arguments..., &wrong.error);
      check();
    } else {
      auto result = f(camera_.get(), arguments..., &wrong.error);
      check();
      return result;
    }
  }
  // The same where a camera may do without.
  template <class Function, class... Arguments>
  auto quietly(Function f, Arguments... arguments) {
    return f(camera_.get(), arguments..., nullptr);
  }
  ArvDevice* device() { return arv_camera_get_device(camera_.get()); }
  bool has(const char* feature) { return arv_device_is_feature_available(device(), feature, nullptr) != 0; }

  GenicamSettings settings_;
  std::string place_;
  Held<ArvCamera> camera_;
};

}  // namespace gonio::acquisition::drivers
