// Makers' descriptions of their cameras, read by aravis: what the driver asks for is there, under the name, of the kind
// and in the unit that it believes, and each pixel format has as many bits as its name says.
#include <arv.h>
#include <gtest/gtest.h>

#include <fstream>

#include "acquisition/device/unpack.h"
#include "data.h"
#include "process.h"

using namespace gonio;
using namespace gonio::acquisition;

namespace {

struct Unref {
  void operator()(ArvGc* features) const { g_object_unref(features); }
};
using Features = std::unique_ptr<ArvGc, Unref>;

std::string text_of(const std::filesystem::path& path) {
  if (path.extension() == ".gz") return tests::run({"gzip", "-dc", path.string()}).out;
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// One of the files begins with a line that a tool printed.
Features features_of(std::string text) {
  text.erase(0, std::min(text.find("<?xml"), text.find("<RegisterDescription")));
  return Features(arv_gc_new(nullptr, text.data(), text.size()));
}

// Elements by name; "named": those with a name that are no entry of an enumeration.
void count_nodes(ArvDomNode* node, std::map<std::string, int>& counts) {
  for (ArvDomNode* child = arv_dom_node_get_first_child(node); child; child = arv_dom_node_get_next_sibling(child)) {
    const std::string kind = arv_dom_node_get_node_name(child);
    ++counts[kind];
    const bool can_be_named = ARV_IS_GC_FEATURE_NODE(child) || kind == "pVariable";
    if (can_be_named && kind != "EnumEntry" && arv_dom_element_get_attribute(ARV_DOM_ELEMENT(child), "Name"))
      ++counts["named"];
    count_nodes(child, counts);
  }
}

std::vector<std::filesystem::path> feature_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(tests::data("robots/genicam_xml")))
    if (const auto name = entry.path().filename().string(); name.ends_with(".xml") || name.ends_with(".xml.gz"))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

TEST(CameraFeatures, EveryFileIsReadWhole) {
  GONIO_NEEDS_DATA("robots/genicam_xml");
  std::map<std::string, std::vector<int>> listed;
  std::ifstream table(tests::data("robots/genicam_xml/counts.csv"));
  std::string line;
  std::getline(table, line);
  ASSERT_EQ(line.rfind("file,model,vendor,schema,named_nodes,integer,float,enumeration,boolean,command,swissknife,"
                       "converter,",
                       0),
            0U);
  while (std::getline(table, line)) {
    std::istringstream cells(line);
    std::vector<std::string> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    for (std::size_t i = 4; i < 12; ++i) listed[row.at(0)].push_back(std::stoi(row.at(i)));
  }
  int compared = 0;
  for (const auto& path : feature_files()) {
    const std::string text = text_of(path), name = path.filename().string();
    const Features features = features_of(text);
    ASSERT_TRUE(features) << name;
    std::map<std::string, int> n;
    count_nodes(ARV_DOM_NODE(features.get()), n);
    // PvRename, PvFlatten: Allied Vision's own, no nodes of GenApi; aravis leaves them out.
    for (auto at = text.find("<Pv"); at != std::string::npos; at = text.find("<Pv", at + 1))
      n["named"] += text.substr(at, text.find('>', at) - at).find(" Name=") != std::string::npos;
    // Against the text itself, by no parser.
    for (const char* kind : {"Integer", "Float", "Enumeration", "EnumEntry", "Boolean", "Command", "Converter",
                             "IntConverter", "SwissKnife", "IntSwissKnife", "MaskedIntReg", "StructEntry"}) {
      int in_text = 0;
      const std::string begin = std::string("<") + kind;
      for (auto at = text.find(begin); at != std::string::npos; at = text.find(begin, at + 1))
        in_text += text[at + begin.size()] == ' ';
      EXPECT_EQ(n[kind], in_text) << name << " " << kind;
    }
    const auto row = listed.find(name.substr(0, name.find('.')));
    if (row == listed.end()) continue;
    ++compared;
    EXPECT_EQ((std::vector<int>{n["named"], n["Integer"], n["Float"], n["Enumeration"], n["Boolean"], n["Command"],
                                n["SwissKnife"] + n["IntSwissKnife"], n["Converter"] + n["IntConverter"]}),
              row->second)
        << name;
  }
  EXPECT_GE(compared, 4);
}

// The names that the driver or aravis on its behalf writes.
TEST(CameraFeatures, WhatTheDriverAsksForIsThere) {
  GONIO_NEEDS_DATA("robots/genicam_xml");
  int cameras = 0, in_dB = 0;
  for (const auto& path : feature_files()) {
    if (path.filename() == "aravis_test_genicam.xml") continue;  // of no camera: features to test a parser with
    const std::string name = path.filename().string();
    const Features features = features_of(text_of(path));
    ASSERT_TRUE(features) << name;
    const auto node = [&](const char* feature) { return arv_gc_get_node(features.get(), feature); };
    const auto real = [&](const char* feature) { return node(feature) && ARV_IS_GC_FLOAT(node(feature)); };
    EXPECT_TRUE(real("ExposureTime") || real("ExposureTimeAbs")) << name;
    const auto unit_of = [&](const char* feature) -> std::string {
      const char* unit = real(feature) ? arv_gc_float_get_unit(ARV_GC_FLOAT(node(feature))) : nullptr;
      return unit != nullptr ? unit : "";
    };
    for (const char* exposure : {"ExposureTime", "ExposureTimeAbs", "ChunkExposureTime"})
      EXPECT_TRUE(unit_of(exposure).empty() || unit_of(exposure) == "us") << name << " " << exposure;
    for (const char* gain : {"Gain", "ChunkGain"}) {
      EXPECT_TRUE(unit_of(gain).empty() || unit_of(gain) == "dB") << name << " " << gain << " " << unit_of(gain);
      in_dB += unit_of(gain) == "dB";
    }
    EXPECT_TRUE(node("Gain") || node("GainRaw")) << name;
    for (const char* feature : {"PixelFormat", "AcquisitionMode", "AcquisitionStart", "AcquisitionStop", "TriggerMode",
                                "TriggerSource", "TriggerSelector", "PayloadSize", "Width", "Height"})
      EXPECT_TRUE(node(feature)) << name << " " << feature;
    ++cameras;
  }
  EXPECT_GE(cameras, 6);
  EXPECT_GE(in_dB, 3);
}

// "EnumEntry_PixelFormat_BayerRG12Packed": what it is called behind its last stroke.
TEST(CameraFeatures, PixelFormatsHaveTheBitsOfTheirNames) {
  GONIO_NEEDS_DATA("robots/genicam_xml");
  std::set<std::string> checked;
  for (const auto& path : feature_files()) {
    const Features features = features_of(text_of(path));
    ArvGcNode* formats = arv_gc_get_node(features.get(), "PixelFormat");
    if (formats == nullptr || !ARV_IS_GC_ENUMERATION(formats)) continue;
    for (const GSList* entry = arv_gc_enumeration_get_entries(ARV_GC_ENUMERATION(formats)); entry;
         entry = entry->next) {
      auto* one = ARV_GC_ENUM_ENTRY(entry->data);
      std::string name = arv_gc_feature_node_get_name(ARV_GC_FEATURE_NODE(one));
      name.erase(0, name.rfind('_') + 1);
      const auto format = parse_pixel_format(name);
      const auto number = static_cast<std::uint64_t>(arv_gc_enum_entry_get_value(one, nullptr));
      if (!format || number < 0x01000000) continue;  // not by PFNC's numbers
      EXPECT_EQ(format->bits_per_pixel(), static_cast<int>((number >> 16) & 0xff)) << path.filename() << " " << name;
      checked.insert(name);
    }
  }
  EXPECT_GE(checked.size(), 20U);
  for (const char* name : {"Mono12Packed", "Mono12p", "BayerRG12Packed", "Mono16"})
    EXPECT_EQ(checked.count(name), 1U) << name;
}

}  // namespace
