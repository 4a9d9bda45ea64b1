// What people type, turned into a manifest: explain data.csv --model 'a*cos(theta)+b' --observed f --free a=1,b=0.
#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "io/height_map.h"
#include "manifest/sections/forward.h"

namespace gonio::explain::tables {

struct QuickTable {
  std::filesystem::path file;  // CSV or JSON
  std::string model;           // a registered model's name, or an expression
  std::vector<std::string> observed, sigma;
  std::string group, block;
  std::vector<std::pair<std::string, std::string>> units;  // column -> unit, where the heading states none
  std::vector<std::pair<std::string, double>> free;        // parameters and where they start
};
// The table enters as "tables"/STEM with its file, hashed; where units had to be converted that the file itself does
// not state, the rows enter inline in SI. Error(usage) at the option, Error(data) at the file.
manifest::Document quick_document(const QuickTable& quick);

// A height map (io/height_map.h) as a table of the model "heights". What a picture's numbers mean, which it does not
// say itself, enters "reliefs" as roughness(1) writes it.
enum class HeightMapKind { none, own, picture };
HeightMapKind height_map_kind(const std::filesystem::path& file);
manifest::Document height_map_document(const std::filesystem::path& file, const io::HeightPicture& picture = {});

// "a=1,b=0.5" and "theta=deg,f=1/sr". Error(usage) at `place`.
std::vector<std::pair<std::string, std::string>> parse_pairs(const std::string& text, const std::string& place);
std::vector<std::pair<std::string, double>> parse_numbers(const std::string& text, const std::string& place);

}  // namespace gonio::explain::tables
