// genicam://ADDRESS: cameras of GigE Vision and USB3 Vision through aravis. The camera waits for a software trigger
// where it has one, and takes a single frame where it has none; a camera that a cable triggers waits for that line.
// Whatever goes wrong with the connection or with a frame closes the camera; the next frame opens it anew, with a
// stream on a new port, so that nothing that arrives late is taken for what was asked.
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "acquisition/device/connection.h"
#include "acquisition/device/drivers/aravis_camera.h"
#include "acquisition/device/frame_count.h"
#include "acquisition/device/gige_knock.h"
#include "acquisition/device/unpack.h"
#include "acquisition/device/url_query.h"
#include "base/error.h"
#include "base/text.h"

namespace gonio::acquisition::drivers {
namespace {

constexpr const char* camera_remedy = "is it on, and in this network?";

class GenicamCamera : public CameraDevice, AravisCamera {
  // What failed is not believed any more; open() stops what a camera may still send.
  template <class Work>
  auto or_close(const Work& work) {
    try {
      return work();
    } catch (const Error& error) {
      if (error.code() == Exit::unavailable) close();
      throw;
    }
  }

 public:
  GenicamCamera(GenicamSettings settings, std::string place) : AravisCamera(std::move(settings), std::move(place)) {
    open();
  }
  ~GenicamCamera() override {
    if (camera_ && stream_) quietly(arv_camera_stop_acquisition);
    close();
  }

  std::string identity() override {
    const std::scoped_lock lock(one_at_a_time_);
    return or_close([this] {
      if (!camera_) open();
      std::string text;
      for (const char* word : {ask(arv_camera_get_vendor_name), ask(arv_camera_get_model_name),
                               quietly(arv_camera_get_device_serial_number)})
        if (word != nullptr && *word != 0) text += (text.empty() ? "" : " ") + std::string(word);
      return text;
    });
  }

  RawFrame take(const Shot& shot) override {
    const std::scoped_lock lock(one_at_a_time_);
    return or_close([&] {
      if (camera_) knock();  // aravis would ask for seconds
      if (!camera_) open();
      set_exposure(shot.exposure_s);
      if (shot.gain_db) set_gain(*shot.gain_db);
      return grab(shot);
    });
  }

 private:
  void close() {
    chunks_.reset();
    stream_.reset();
    camera_.reset();
  }

  void knock() {
    if (!answers_as_gige_camera(settings_.address, settings_.timeout_s))
      throw failure("does not answer within " + shortest_text(settings_.timeout_s) + " s", camera_remedy);
  }

  void open() {
    close();
    knock();
    Wrong wrong;
    camera_.reset(arv_camera_new(settings_.address.c_str(), &wrong.error));
    if (!camera_) throw failure(wrong.error != nullptr ? wrong.error->message : "there is none", camera_remedy);
    if (ARV_IS_GV_DEVICE(device()) && !arv_gv_device_is_controller(ARV_GV_DEVICE(device())))
      throw failure("another program holds it", "close that program");
    quietly(arv_camera_stop_acquisition);  // whoever had it before may have left it running
    choose_pixel_format();
    settle();
    choose_trigger();
    enable_chunks();
    start();
  }

  void choose_pixel_format() {
    guint count = 0;
    const char** names = ask(arv_camera_dup_available_pixel_formats_as_strings, &count);
    std::string usable;
    bool offered = settings_.pixel_format.empty();
    for (guint i = 0; i < count; ++i) {
      if (parse_pixel_format(names[i])) usable += (usable.empty() ? "" : ", ") + std::string(names[i]);
      offered = offered || settings_.pixel_format == names[i];
    }
    g_free(names);
    if (!offered) throw impossible("has no pixel format " + settings_.pixel_format, "it has " + usable);
    if (!settings_.pixel_format.empty()) ask(arv_camera_set_pixel_format_from_string, settings_.pixel_format.c_str());
    const std::string now = ask(arv_camera_get_pixel_format_as_string);
    if (!settings_.pixel_format.empty() && now != settings_.pixel_format)
      throw failure("stays at pixel format " + now, "it was asked for " + settings_.pixel_format);
    const auto format = parse_pixel_format(now);
    if (!format)
      throw impossible("writes " + now + ", which is not as the sensor saw it", "pixel_format= one of " + usable);
    format_ = *format;
  }

  // Nothing that changes a frame on its own, or that shortens its exposure.
  void settle() {
    if (quietly(arv_camera_is_exposure_auto_available)) ask(arv_camera_set_exposure_time_auto, ARV_AUTO_OFF);
    if (quietly(arv_camera_is_gain_auto_available)) ask(arv_camera_set_gain_auto, ARV_AUTO_OFF);
    for (const char* limiter : {"AcquisitionFrameRateEnable", "AcquisitionFrameRateEnabled"})
      if (has(limiter)) arv_device_set_boolean_feature_value(device(), limiter, 0, nullptr);
    if (settings_.packet_size > 0 && arv_camera_is_gv_device(camera_.get())) {
      ask(arv_camera_gv_set_packet_size, settings_.packet_size);
      if (const auto now = ask(arv_camera_gv_get_packet_size); static_cast<int>(now) != settings_.packet_size)
        throw failure(format("its packets stay at %u bytes", now), "packet-size= a size that camera and network can");
    }
    if (!ask(arv_camera_is_exposure_time_available)) throw impossible("its exposure cannot be set", {});
  }

  void choose_trigger() {
    const bool soft = quietly(arv_camera_is_software_trigger_supported) != 0;
    if (settings_.trigger == "software" && !soft)
      throw impossible("has no software trigger", "trigger=none takes single frames");
    commanded_ = settings_.trigger == "software" || (settings_.trigger.empty() && soft);
    single_ = settings_.trigger == "none" || (settings_.trigger.empty() && !soft);
    if (single_) {
      quietly(arv_camera_clear_triggers);
      ask(arv_camera_set_acquisition_mode, ARV_ACQUISITION_MODE_SINGLE_FRAME);
      return;
    }
    if (!commanded_ &&
        !arv_device_is_enumeration_entry_available(device(), "TriggerSource", settings_.trigger.c_str(), nullptr))
      throw impossible("has no trigger " + settings_.trigger, "trigger=software, or a line that it has");
    ask(arv_camera_set_acquisition_mode, ARV_ACQUISITION_MODE_CONTINUOUS);
    ask(arv_camera_set_trigger, commanded_ ? "Software" : settings_.trigger.c_str());
  }

  // What the camera writes behind its pixels about this very frame. Names: SFNC 2.7; counters
  // of other names begin where they like, and say nothing of the frame that they came with.
  void enable_chunks() {
    if (!quietly(arv_camera_are_chunks_available)) return;
    ask(arv_camera_set_chunk_mode, 1);
    for (const char* chunk : {"ExposureTime", "Gain", "FrameID"})
      if (arv_device_is_enumeration_entry_available(device(), "ChunkSelector", chunk, nullptr))
        ask(arv_camera_set_chunk_state, chunk, 1);
    chunks_.reset(arv_camera_create_chunk_parser(camera_.get()));
  }

  // As root, aravis reads a raw socket, which hears all that passes from its making until its filter stands: the frames
  // of other cameras were taken for this one's. Its port of UDP hears nothing else, and is what other users get anyway.
  // A machine that is busy empties that late: its queue holds several frames, where the system lets it (rmem_max).
  void start() {
    if (ARV_IS_GV_DEVICE(device()))
      arv_gv_device_set_stream_options(ARV_GV_DEVICE(device()), ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
    stream_.reset(ask(arv_camera_create_stream, nullptr, nullptr));
    if (!stream_) throw failure("opens no stream", "is its network interface up?");
    if (ARV_IS_GV_STREAM(stream_.get()))
      g_object_set(stream_.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size", queue_bytes,
                   nullptr);
    const auto payload = ask(arv_camera_get_payload);
    for (int i = 0; i < 3; ++i) arv_stream_push_buffer(stream_.get(), arv_buffer_new_allocate(payload));
    count_.restarted();
    if (!single_) ask(arv_camera_start_acquisition);
  }

  void set_exposure(double exposure_s) {
    double shortest = 0, longest = 0;
    ask(arv_camera_get_exposure_time_bounds, &shortest, &longest);
    const double us = exposure_s * 1e6, slack = 1e-9 * us;
    if (!(us >= shortest - slack && us <= longest + slack))
      throw impossible(
          format("exposure is %.6g ms, it can %.6g to %.6g ms", us * 1e-3, shortest * 1e-3, longest * 1e-3),
          "ask for another exposure, or change the light");
    ask(arv_camera_set_exposure_time, std::clamp(us, shortest, longest));
  }

  // SFNC's Gain, a float, is in dB; of counts somebody must say what one is.
  struct GainFeature {
    const char* name = nullptr;
    bool real = false;
    std::optional<double> step_db;
  };
  GainFeature gain_feature() {
    if (has("Gain") && ARV_IS_GC_FLOAT(arv_device_get_feature(device(), "Gain"))) return {"Gain", true, 1.0};
    const auto step_db = settings_.gain_step_db > 0 ? std::optional(settings_.gain_step_db) : std::nullopt;
    return {has("Gain") ? "Gain" : has("GainRaw") ? "GainRaw" : nullptr, false, step_db};
  }
  void set_gain(double gain_db) {
    const GainFeature gain = gain_feature();
    if (gain.name == nullptr) throw impossible("its gain cannot be set", "leave gain_db out");
    if (!gain.step_db)
      throw impossible("its gain is a count without a unit", "gain-step=0.1, the dB that one is, or leave gain_db out");
    double lowest = 0, highest = 0;
    gint64 least = 0, most = 0;
    if (gain.real) {
      ask(arv_camera_get_float_bounds, gain.name, &lowest, &highest);
    } else {
      ask(arv_camera_get_integer_bounds, gain.name, &least, &most);
      lowest = static_cast<double>(least) * *gain.step_db;
      highest = static_cast<double>(most) * *gain.step_db;
    }
    if (!(gain_db >= lowest - 1e-9 && gain_db <= highest + 1e-9))
      throw impossible(format("gain is %g dB, it can %g to %g dB", gain_db, lowest, highest), "ask for another gain");
    if (gain.real)
      ask(arv_camera_set_float, gain.name, std::clamp(gain_db, lowest, highest));
    else
      ask(arv_camera_set_integer, gain.name, std::clamp<gint64>(std::llround(gain_db / *gain.step_db), least, most));
  }
  std::optional<double> gain_now() {
    const GainFeature gain = gain_feature();
    if (gain.name == nullptr || !gain.step_db) return {};
    if (gain.real) return ask(arv_camera_get_float, gain.name);
    return static_cast<double>(ask(arv_camera_get_integer, gain.name)) * *gain.step_db;
  }

  std::uint64_t missing_packets() {
    return ARV_IS_GV_STREAM(stream_.get()) ? arv_stream_get_info_uint64_by_name(stream_.get(), "n_missing_packets") : 0;
  }

  // aravis asks the camera every second whether it is still ours: one that went away is not waited for.
  Held<ArvBuffer> buffer_within(double patience_s) {
    for (const auto until = after(patience_s);;) {
      const double left_s = std::chrono::duration<double>(until - Clock::now()).count();
      const double step_s = std::clamp(left_s, 0.0, 0.5);
      Held<ArvBuffer> buffer(
          arv_stream_timeout_pop_buffer(stream_.get(), static_cast<guint64>(std::lround(step_s * 1e6))));
      if (buffer || left_s <= step_s) return buffer;
      if (ARV_IS_GV_DEVICE(device()) && !arv_gv_device_is_controller(ARV_GV_DEVICE(device())))
        throw failure("went away while a frame was waited for", camera_remedy);
    }
  }

  // A frame that was not whole may still come, after the next trigger, and be taken for that one's.
  void drain() {
    const auto until = after(stray_s);
    const auto next = [&] {  // a camera that runs by itself sends for ever
      return in_doubt_ && Clock::now() < until
                 ? arv_stream_timeout_pop_buffer(stream_.get(), static_cast<guint64>(1e6 * stray_s))
                 : arv_stream_try_pop_buffer(stream_.get());
    };
    while (ArvBuffer* old = next()) arv_stream_push_buffer(stream_.get(), old);
    in_doubt_ = true;  // until a whole one came
  }

  RawFrame grab(const Shot& shot) {
    drain();
    const std::uint64_t missing_before = missing_packets();
    if (single_) ask(arv_camera_start_acquisition);
    if (commanded_) ask(arv_camera_software_trigger);
    const double patience_s = shot.exposure_s + settings_.readout_s + settings_.timeout_s;
    Held<ArvBuffer> buffer = buffer_within(patience_s);
    if (!buffer)
      throw failure("no frame within " + format("%.3g s", patience_s),
                    commanded_ || single_ ? "does a firewall keep UDP away? is another trigger selected?"
                                          : "does anything come on " + settings_.trigger + "?");
    if (single_) ask(arv_camera_stop_acquisition);
    RawFrame frame = frame_of(buffer.get(), missing_before);
    in_doubt_ = frame.incomplete_packets > 0;
    arv_stream_push_buffer(stream_.get(), buffer.release());
    return frame;
  }

  RawFrame frame_of(ArvBuffer* buffer, std::uint64_t missing_before) {
    RawFrame frame;
    frame.bits = format_.bits;
    frame.pixel_format = format_.unpacked();
    const std::uint64_t counted = arv_buffer_get_frame_id(buffer);
    frame.frame_id = count_.number_of(counted);
    const auto status = arv_buffer_get_status(buffer);
    if (status == ARV_BUFFER_STATUS_SIZE_MISMATCH)
      throw failure("its frames have another size than was agreed", "did another program change its settings?");
    if (status != ARV_BUFFER_STATUS_SUCCESS) {
      // No pixels: what a lost packet would have brought is whatever the frame before left there. On a busy machine a
      // buffer may even come back empty ("cleared"): that, too, is a frame to take again, not a camera to give up.
      const std::uint64_t missing = missing_packets() - missing_before;
      frame.incomplete_packets = static_cast<std::int64_t>(std::max<std::uint64_t>(1, missing));
      return frame;
    }
    read_pixels(buffer, frame);
    if (const auto ns = arv_buffer_get_timestamp(buffer); ns != 0) frame.camera_time_s = static_cast<double>(ns) * 1e-9;
    frame.exposure_s = ask(arv_camera_get_exposure_time) / 1e6;
    frame.gain_db = gain_now();
    if (has("DeviceTemperature")) frame.temperature_K = 273.15 + ask(arv_camera_get_float, "DeviceTemperature");
    read_chunks(buffer, counted, frame);
    return frame;
  }

  void read_pixels(ArvBuffer* buffer, RawFrame& frame) {
    frame.width_px = arv_buffer_get_image_width(buffer);
    frame.height_px = arv_buffer_get_image_height(buffer);
    const auto code = arv_buffer_get_image_pixel_format(buffer);
    if (const auto bits = ARV_PIXEL_FORMAT_BIT_PER_PIXEL(code); static_cast<int>(bits) != format_.bits_per_pixel())
      throw failure(format("its pixels have %d bits (format 0x%08x), %d were agreed", static_cast<int>(bits),
                           static_cast<unsigned>(code), format_.bits_per_pixel()),
                    "did another program change its pixel format?");
    gint after_row = 0, after_image = 0;
    arv_buffer_get_image_padding(buffer, &after_row, &after_image);
    std::size_t size = 0;
    const auto* bytes = static_cast<const std::uint8_t*>(arv_buffer_get_image_data(buffer, &size));
    frame.samples = unpack({bytes, size}, frame.width_px, frame.height_px, after_row, format_, place_);
  }

  void read_chunks(ArvBuffer* buffer, std::uint64_t counted, RawFrame& frame) {
    if (!chunks_ || !arv_buffer_has_chunks(buffer)) return;
    const auto real = [&](const char* name) -> std::optional<double> {
      if (!ARV_IS_GC_FLOAT(arv_device_get_feature(device(), name))) return {};
      Wrong wrong;
      const double value = arv_chunk_parser_get_float_value(chunks_.get(), buffer, name, &wrong.error);
      return wrong.error == nullptr ? std::optional(value) : std::nullopt;
    };
    if (const auto us = real("ChunkExposureTime")) frame.exposure_s = *us / 1e6;
    if (const auto db = real("ChunkGain")) frame.gain_db = *db;
    if (arv_device_get_feature(device(), "ChunkFrameID") == nullptr) return;
    Wrong wrong;
    const gint64 id = arv_chunk_parser_get_integer_value(chunks_.get(), buffer, "ChunkFrameID", &wrong.error);
    if (wrong.error == nullptr)
      frame.chunk_frame_id = FrameCount::number_of_chunk(static_cast<std::uint64_t>(id), counted, frame.frame_id);
  }

  static constexpr double stray_s = 0.2;
  static constexpr gint queue_bytes = 1 << 25;
  bool in_doubt_ = false;
  std::mutex one_at_a_time_;
  Held<ArvStream> stream_;
  Held<ArvChunkParser> chunks_;
  PixelFormat format_;
  FrameCount count_;
  bool commanded_ = false, single_ = false;
};

std::unique_ptr<CameraDevice> genicam_camera(const Url& url, const std::string& place) {
  if (url.host.empty() || url.port || (!url.path.empty() && url.path != "/"))
    throw Error(Exit::usage, place, url.text + ": names no camera", "write genicam://ADDRESS");
  UrlQuery query(url, place);
  GenicamSettings settings;
  settings.address = url.host;
  settings.pixel_format = query.text("pixel_format");
  if (!settings.pixel_format.empty() && !parse_pixel_format(settings.pixel_format))
    throw Error(Exit::usage, place, url.text + ": pixel_format is '" + settings.pixel_format + "'",
                "Mono, BayerRG, Polarized, ... with 8 to 16 bits, as Mono12p, BayerRG12Packed, Polarized8");
  settings.trigger = query.text("trigger");
  settings.packet_size = query.integer("packet-size", 0, 0, 16260);
  settings.gain_step_db = query.quantity("gain-step", Dimension::none, 0, 0, 10);
  settings.readout_s = query.quantity("readout", Dimension::time, 0, 0, 3600);
  settings.timeout_s = query.timeout(3);
  query.end();
  return std::make_unique<GenicamCamera>(std::move(settings), place);
}

}  // namespace

const Driver& genicam() {
  static const Driver its_driver = [] {
    Driver driver;
    driver.scheme = "genicam";
    driver.sentence =
        "genicam://ADDRESS is a camera of GigE Vision, by its address, or of USB3 Vision, by aravis's name of it "
        "(pixel_format=Mono12p; trigger=software, none for single frames, or the line of a cable, as Line0; "
        "packet-size=1400; gain-step=0.1, the dB of one where its gain is a count; readout=0s from the end of an "
        "exposure until its "
        "frame may come; timeout=3s beyond both).";
    driver.camera = genicam_camera;
    driver.camera_keys = {"pixel_format", "trigger"};
    return driver;
  }();
  return its_driver;
}

}  // namespace gonio::acquisition::drivers
