// Lamps, turntables and screens that take a line of text and answer one: on a serial line, or as a program's arguments.
// A template is words with {deg} (an angle in degrees) or {file} (a path) in them. What they did is asked of them: a
// lamp needs an answer to its command, or a question that says what it does.
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "acquisition/device/devices.h"
#include "acquisition/device/url_query.h"

namespace gonio::acquisition {

struct TextLine {
  std::string what;  // "serial line /dev/ttyUSB0"
  std::string place;
  bool acknowledges = false;  // ask() itself fails where the command was not carried out
  // A command with its blanks filled in. A question has an answer, without its end; other commands may have none.
  // Error(unavailable) where it did not come.
  struct Command {
    std::string text, blank{}, value{};
    bool question = false;
  };
  std::function<std::string(const Command&)> ask;
};

// Of the query: on, off, answer; state, state-on, state-off. The line's own keys were read before.
std::unique_ptr<LampDevice> make_text_lamp(TextLine line, UrlQuery& query);
// turn (with {deg}), angle, scale (1deg: what an answered 1 is), stop, tolerance, stall.
std::unique_ptr<TurntableDevice> make_text_turntable(TextLine line, UrlQuery& query);
// show (with {file}), black.
std::unique_ptr<ScreenDevice> make_text_screen(TextLine line, UrlQuery& query);

}  // namespace gonio::acquisition
