// URLs of devices (RFC 3986, what is needed of it), and the drivers by scheme.
#include <algorithm>
#include <cctype>
#include <charconv>

#include "acquisition/device/devices.h"
#include "acquisition/device/url_query.h"
#include "base/error.h"
#include "base/text.h"

namespace gonio::acquisition {
namespace {

constexpr const char* url_shape = "write scheme://host:port/path?key=value&key=value; blanks and the like as %20";

[[noreturn]] void no_url(const std::string& text, const std::string& place, const std::string& problem) {
  std::string shown;
  for (const char c : text.substr(0, 120)) shown += std::isprint(static_cast<unsigned char>(c)) ? c : '?';
  throw Error(Exit::usage, place, "'" + shown + "' is no URL of a device: " + problem, url_shape);
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decoded(std::string_view part, const std::string& text, const std::string& place) {
  std::string plain;
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (part[i] != '%') {
      plain += part[i];
      continue;
    }
    const int high = i + 2 < part.size() ? hex_digit(part[i + 1]) : -1;
    const int low = i + 2 < part.size() ? hex_digit(part[i + 2]) : -1;
    if (high < 0 || low < 0) no_url(text, place, "after % two hexadecimal digits are missing");
    plain += static_cast<char>(high * 16 + low);
    if (plain.back() == 0) no_url(text, place, "%00 ends a text within");
    i += 2;
  }
  return plain;
}

std::optional<int> port_number(std::string_view digits) {
  int port = 0;
  const auto [end, wrong] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (wrong != std::errc{} || end != digits.data() + digits.size() || port < 1 || port > 65535) return {};
  return port;
}

// host, host:port, [v6]:port
void read_authority(std::string_view authority, Url& url, const std::string& place) {
  if (authority.find('@') != std::string_view::npos) no_url(url.text, place, "user names are not sent to devices");
  std::string_view host = authority, digits;
  bool has_port = false;
  if (!authority.empty() && authority[0] == '[') {
    const auto close = authority.find(']');
    if (close == std::string_view::npos) no_url(url.text, place, "'[' without ']'");
    host = authority.substr(1, close - 1);
    if (host.empty()) no_url(url.text, place, "nothing between '[' and ']'");
    const auto rest = authority.substr(close + 1);
    if (!rest.empty() && rest[0] != ':') no_url(url.text, place, "after ']' comes ':' or '/'");
    has_port = !rest.empty();
    if (has_port) digits = rest.substr(1);
  } else if (const auto colon = authority.find(':'); colon != std::string_view::npos) {
    host = authority.substr(0, colon);
    has_port = true;
    digits = authority.substr(colon + 1);
  }
  url.host = percent_decoded(host, url.text, place);
  if (!has_port) return;
  url.port = port_number(digits);
  if (!url.port) no_url(url.text, place, "its port is '" + std::string(digits) + "', ports are 1 .. 65535");
  if (url.host.empty()) no_url(url.text, place, "a port without a host");
}

void read_query(std::string_view query, Url& url, const std::string& place) {
  while (!query.empty()) {
    const auto end = std::min(query.find('&'), query.size());
    const auto item = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    if (item.empty()) continue;
    const auto equals = item.find('=');
    if (equals == std::string_view::npos) no_url(url.text, place, "'" + std::string(item) + "' has no value");
    const std::string key = percent_decoded(item.substr(0, equals), url.text, place);
    if (key.empty()) no_url(url.text, place, "a value without a key");
    if (!url.query.emplace(key, percent_decoded(item.substr(equals + 1), url.text, place)).second)
      no_url(url.text, place, "'" + key + "' is given twice");
  }
}

}  // namespace

Url parse_url(const std::string& text, const std::string& place) {
  Url url;
  url.text = text;
  for (const char c : text)
    if (const auto byte = static_cast<unsigned char>(c); byte <= 32 || byte >= 127)
      no_url(text, place, "it holds a blank, a control character or one beyond ASCII");
  const auto colon = text.find("://");
  if (colon == std::string::npos || colon == 0) no_url(text, place, "it has no scheme");
  url.scheme = text.substr(0, colon);
  const auto in_scheme = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.';
  };
  if (!std::all_of(url.scheme.begin(), url.scheme.end(), in_scheme) || !(url.scheme[0] >= 'a' && url.scheme[0] <= 'z'))
    no_url(text, place, "schemes are small letters, digits, + - .");
  std::string_view rest = std::string_view(text).substr(colon + 3);
  if (rest.find('#') != std::string_view::npos) no_url(text, place, "'#' names a part of a document; write %23");
  const auto question = rest.find('?');
  if (question != std::string_view::npos) {
    read_query(rest.substr(question + 1), url, place);
    rest = rest.substr(0, question);
  }
  const auto slash = std::min(rest.find('/'), rest.size());
  read_authority(rest.substr(0, slash), url, place);
  url.path = percent_decoded(rest.substr(slash), text, place);
  return url;
}

std::string with_query(const std::string& url, const std::string& key, const std::string& value,
                       const std::string& place) {
  const Url parsed = parse_url(url, place);
  if (parsed.query.count(key) != 0) no_url(url, place, "'" + key + "' is given twice");
  std::string quoted;
  for (const char c : value) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = std::isalnum(byte) != 0 || c == '/' || c == '.' || c == '-' || c == '_' || c == '~';
    quoted += plain && byte < 128 ? std::string(1, c) : format("%%%02X", static_cast<unsigned>(byte));
  }
  const char* joint = url.find('?') == std::string::npos ? "?" : "&";
  return url + joint + key + "=" + quoted;
}

std::string camera_url(const std::string& url, const std::string& pixel_format, const std::string& trigger,
                       const std::string& place) {
  const Url parsed = parse_url(url, place);
  const auto found = std::ranges::find(all_drivers(), parsed.scheme, [](const Driver* d) { return d->scheme; });
  if (found == all_drivers().end()) return url;
  std::string whole = url;
  // `own`: what the laboratory says; `fits`: may the URL say this beside it?
  const auto say = [&](const std::string& key, const std::string& own, const auto& fits) {
    const auto& keys = (*found)->camera_keys;
    if (own.empty() || std::ranges::find(keys, key) == keys.end()) return;
    const auto given = parsed.query.find(key);
    if (given == parsed.query.end())
      whole = with_query(whole, key, own, place);
    else if (!fits(given->second))
      throw Error(Exit::data, place, url + ": the laboratory says " + key + " " + own, "let both say the same");
  };
  say("pixel_format", pixel_format, [&](const std::string& text) { return text == pixel_format; });
  if (trigger == "hardware")
    say("trigger", "Line0", [](const std::string& text) { return text != "software" && text != "none"; });
  else
    say("trigger", trigger, [&](const std::string& text) { return text == trigger; });
  return whole;
}

namespace {

template <class Device>
std::unique_ptr<Device> open_device(const std::string& text, const std::string& place, const char* kind,
                                    std::unique_ptr<Device> (*Driver::*opener)(const Url&, const std::string&)) {
  const Url url = parse_url(text, place);
  std::string schemes;
  const Driver* found = nullptr;
  for (const Driver* driver : all_drivers()) {
    if (driver->scheme == url.scheme) found = driver;
    if (driver->*opener != nullptr) schemes += (schemes.empty() ? "" : ", ") + driver->scheme + "://";
  }
  const std::string remedy = schemes.empty() ? "no driver for this kind is built in" : "there are " + schemes;
  if (found == nullptr) throw Error(Exit::usage, place, "no driver for '" + url.scheme + "://'", remedy);
  if (found->*opener == nullptr) throw Error(Exit::usage, place, "'" + url.scheme + "://' reaches no " + kind, remedy);
  return (found->*opener)(url, place);
}

}  // namespace

std::unique_ptr<RobotDevice> open_robot(const std::string& url, const std::string& place) {
  return open_device(url, place, "robot", &Driver::robot);
}
std::unique_ptr<CameraDevice> open_camera(const std::string& url, const std::string& place) {
  return open_device(url, place, "camera", &Driver::camera);
}
std::unique_ptr<LampDevice> open_lamp(const std::string& url, const std::string& place) {
  return open_device(url, place, "lamp", &Driver::lamp);
}
std::unique_ptr<TurntableDevice> open_turntable(const std::string& url, const std::string& place) {
  return open_device(url, place, "turntable", &Driver::turntable);
}
std::unique_ptr<ScreenDevice> open_screen(const std::string& url, const std::string& place) {
  return open_device(url, place, "screen", &Driver::screen);
}

const std::string* UrlQuery::find(const std::string& key) {
  known_ += (known_.empty() ? "" : ", ") + key;
  const auto at = url_.query.find(key);
  return at == url_.query.end() ? nullptr : &at->second;
}

void UrlQuery::refuse(const std::string& problem, const std::string& remedy) const {
  throw Error(Exit::usage, place_, url_.text + ": " + problem, remedy);
}

std::string UrlQuery::text(const std::string& key, const std::string& preset) {
  const std::string* value = find(key);
  return value == nullptr ? preset : *value;
}

std::string UrlQuery::required(const std::string& key, const std::string& meaning) {
  const std::string value = text(key);
  if (value.empty()) refuse("'" + key + "' is missing", "add " + key + "=, " + meaning);
  return value;
}

int UrlQuery::integer(const std::string& key, int preset, int lower, int upper) {
  const std::string* value = find(key);
  if (value == nullptr) return preset;
  int number = 0;
  const auto [end, wrong] = std::from_chars(value->data(), value->data() + value->size(), number);
  if (wrong != std::errc{} || end != value->data() + value->size() || number < lower || number > upper)
    refuse(key + " is '" + *value + "'", format("a whole number from %d to %d", lower, upper));
  return number;
}

double UrlQuery::quantity(const std::string& key, Dimension dimension, double preset, double lower, double upper) {
  const std::string* value = find(key);
  if (value == nullptr) return preset;
  const double number = parse_quantity(*value, dimension, place_ + ": " + url_.scheme + ":// " + key);
  if (!(number >= lower && number <= upper))
    refuse(key + " is '" + *value + "'",
           "from " + shortest_text(lower) + " to " + shortest_text(upper) + " " + std::string(si_unit(dimension)));
  return number;
}

bool UrlQuery::flag(const std::string& key, bool preset) {
  const std::string value = text(key, preset ? "yes" : "no");
  if (value != "yes" && value != "no") refuse(key + " is '" + value + "'", "yes or no");
  return value == "yes";
}

std::optional<int> UrlQuery::port(const std::string& key, int preset) {
  const std::string* value = find(key);
  if (value == nullptr) return preset;
  if (*value == "none") return {};
  const auto number = port_number(*value);
  if (!number) refuse(key + " is '" + *value + "'", "a port from 1 to 65535, or none");
  return number;
}

void UrlQuery::end() const {
  const std::string listed = ", " + known_ + ",";
  for (const auto& [key, value] : url_.query)
    if (listed.find(", " + key + ",") == std::string::npos)
      refuse("'" + key + "' is not known", known_.empty() ? "it takes none" : "it knows " + known_);
}

int UrlQuery::path_number(std::string_view word, int upper) const {
  const std::string before = "/" + std::string(word) + "/";
  int number = -1;
  if (url_.path.compare(0, before.size(), before) == 0) {
    const char* last = url_.path.data() + url_.path.size();
    const auto [end, wrong] = std::from_chars(url_.path.data() + before.size(), last, number);
    if (wrong != std::errc{} || end != last) number = -1;
  }
  if (number < 0 || number > upper)
    refuse("its path is '" + url_.path + "'", "write " + before + "N with N from 0 to " + std::to_string(upper));
  return number;
}

}  // namespace gonio::acquisition
