#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/device/devices.h"
#include "acquisition/device/url_query.h"
#include "base/error.h"
#include "base/random.h"

using namespace gonio;
using namespace gonio::acquisition;

namespace {

TEST(DeviceUrl, HasParts) {
  const Url url = parse_url("modbus://robot-left:1502/coil/3?unit=7&on=A%20B%3D1&empty=", "here");
  EXPECT_EQ(url.scheme, "modbus");
  EXPECT_EQ(url.host, "robot-left");
  EXPECT_EQ(url.port, 1502);
  EXPECT_EQ(url.path, "/coil/3");
  EXPECT_EQ(url.query.at("unit"), "7");
  EXPECT_EQ(url.query.at("on"), "A B=1");
  EXPECT_EQ(url.query.at("empty"), "");
  EXPECT_EQ(parse_url("serial:///dev/ttyUSB0?baud=9600", "here").path, "/dev/ttyUSB0");
  EXPECT_EQ(parse_url("serial:///dev/ttyUSB0", "here").host, "");
  EXPECT_EQ(parse_url("sim://", "here").path, "");
  EXPECT_EQ(parse_url("modbus://[fe80::1]:503", "here").host, "fe80::1");
  EXPECT_EQ(parse_url("modbus://[fe80::1]:503", "here").port, 503);
  EXPECT_FALSE(parse_url("genicam://10.0.0.2", "here").port);
}

TEST(DeviceUrl, MalformedIsRefusedInWords) {
  for (const char* text : {"",
                           "modbus",
                           "://x",
                           "modbus:/x",
                           "Modbus://x",
                           "modbus://x:0",
                           "modbus://x:65536",
                           "modbus://x:port",
                           "modbus://x:",
                           "modbus://:502",
                           "modbus://me@x",
                           "modbus://x#part",
                           "modbus://x?key",
                           "modbus://x?=v",
                           "modbus://x?a=1&a=2",
                           "modbus://x/%",
                           "modbus://x/%4",
                           "modbus://x/%zz",
                           "modbus://x/%00",
                           "modbus://a b",
                           "modbus://[::1",
                           "modbus://[]",
                           "modbus://[::1]x",
                           "modbus://\xc3\xa4",
                           "modbus://x\n",
                           "3d://x"}) {
    try {
      parse_url(text, "lab.json#/url");
      ADD_FAILURE() << "'" << text << "' was taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::usage) << text;
      EXPECT_EQ(error.place(), "lab.json#/url");
      EXPECT_NE(error.problem().find("is no URL of a device: "), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

// Whatever is typed: parts or one clear line; and what is taken is found again in its parts.
TEST(DeviceUrl, AnyTextIsTakenOrRefused) {
  Random random(3);
  const std::string alphabet = "modbus://:/?&=%#@[]0123456789abcXYZ .-_~\n\t\xff";
  int taken = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string text = round % 2 == 0 ? "modbus://host:502/coil/3?unit=1&on=a%20b" : "";
    const int changes = 1 + static_cast<int>(random.below(round % 2 == 0 ? 4 : 40));
    for (int i = 0; i < changes; ++i) {
      const char c = alphabet[random.below(static_cast<std::uint32_t>(alphabet.size()))];
      const auto at = random.below(static_cast<std::uint32_t>(text.size() + 1));
      if (random.below(3) == 0 && at < text.size())
        text.erase(at, 1);
      else
        text.insert(at, 1, c);
    }
    try {
      const Url url = parse_url(text, "here");
      ++taken;
      EXPECT_EQ(text.compare(0, url.scheme.size() + 3, url.scheme + "://"), 0);
      EXPECT_TRUE(!url.port || (*url.port > 0 && *url.port < 65536));
      EXPECT_TRUE(url.path.empty() || url.path[0] == '/' || text.find('%') != std::string::npos) << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::usage);
    }
  }
  EXPECT_GT(taken, 1000);
}

TEST(DeviceUrl, AValueMayHoldAnything) {
  Random random(5);
  for (int round = 0; round < 2000; ++round) {
    std::string value;
    for (int i = static_cast<int>(random.below(20)); i >= 0; --i) value += static_cast<char>(1 + random.below(255));
    const std::string text = with_query(round % 2 ? "modbus://x" : "modbus://x?a=1", "registers", value, "here");
    EXPECT_EQ(parse_url(text, "here").query.at("registers"), value);
  }
  EXPECT_THROW(with_query("modbus://x?a=1", "a", "2", "here"), Error);
}

TEST(DeviceUrl, QueriesHaveTypesAndLimits) {
  const auto read = [](const char* text, auto ask) {
    const Url url = parse_url(text, "here");
    UrlQuery query(url, "here");
    const auto value = ask(query);
    query.end();
    return value;
  };
  const auto unit = [](UrlQuery& query) { return query.integer("unit", 1, 0, 255); };
  EXPECT_EQ(read("m://x", unit), 1);
  EXPECT_EQ(read("m://x?unit=17", unit), 17);
  for (const char* text : {"m://x?unit=256", "m://x?unit=-1", "m://x?unit=1.5", "m://x?unit=", "m://x?unit=1&other=2"})
    EXPECT_THROW(read(text, unit), Error) << text;
  const auto timeout = [](UrlQuery& query) { return query.timeout(2); };
  EXPECT_DOUBLE_EQ(read("m://x?timeout=250ms", timeout), 0.25);
  for (const char* text : {"m://x?timeout=2", "m://x?timeout=2m", "m://x?timeout=0s", "m://x?timeout=nans"})
    EXPECT_THROW(read(text, timeout), Error) << text;
  const auto port = [](UrlQuery& query) { return query.port("dashboard", 29999); };
  EXPECT_EQ(read("m://x", port), 29999);
  EXPECT_FALSE(read("m://x?dashboard=none", port));
  EXPECT_THROW(read("m://x?dashboard=0", port), Error);
}

std::string refusal(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(DeviceUrl, SchemesAreListed) {
  const std::string unknown = refusal([] { open_robot("telepathy://left", "lab.json#/laboratory/robots/left/url"); });
  EXPECT_THAT(unknown, testing::HasSubstr("lab.json#/laboratory/robots/left/url: no driver for 'telepathy://'"));
  EXPECT_THAT(unknown, testing::HasSubstr("modbus://"));
  EXPECT_THAT(unknown, testing::Not(testing::HasSubstr("serial://")));  // no robot there
  EXPECT_THAT(refusal([] { open_robot("serial:///dev/ttyS0", "here"); }),
              testing::HasSubstr("'serial://' reaches no robot"));
  EXPECT_THAT(refusal([] { open_lamp("telepathy://left", "here"); }), testing::HasSubstr("serial://"));
}

// What is wrong with a URL is said when it is opened, before anything is reached.
TEST(DeviceUrl, DriversRefuseWhatTheyDoNotKnow) {
  const std::vector<std::pair<const char*, const char*>> lamps{
      {"modbus://x", "its path is ''"},
      {"modbus:///coil/1", "names no host"},
      {"modbus://x/coil/70000", "its path is '/coil/70000'"},
      {"modbus://x/coil/1?untie=3", "'untie' is not known"},
      {"modbus://x/coil/1?unit=250", "unit is 250"},
      {"serial://ttyUSB0?on=1&off=0&answer=OK", "names no device"},
      {"serial:///dev/x?on=1", "'off' is missing"},
      {"serial:///dev/x?on=1&off=0", "nothing says whether the lamp is lit"},
      {"serial:///dev/x?on=1&off=0&answer=OK&baud=9601", "no line runs at 9601 baud"},
      {"command://relay?on=1&off=0", "names no program"}};
  for (const auto& [url, words] : lamps)
    EXPECT_THAT(refusal([&, u = url] { open_lamp(u, "here"); }), testing::HasSubstr(words)) << url;
  EXPECT_THAT(refusal([] { open_turntable("modbus://x/register/7", "here"); }),
              testing::HasSubstr("'scale' is missing"));
  EXPECT_THAT(refusal([] { open_turntable("serial:///dev/x?turn=G0&angle=A&stop=S", "here"); }),
              testing::HasSubstr("has no {deg}"));
  EXPECT_THAT(refusal([] { open_robot("modbus://x/coil/3", "here"); }), testing::HasSubstr("has no path"));
  EXPECT_THAT(refusal([] { open_robot("modbus://x?registers=/nowhere/map.json", "here"); }),
              testing::HasSubstr("/nowhere/map.json cannot be read"));
}

}  // namespace
