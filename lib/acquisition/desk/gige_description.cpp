// What a simulated camera says of itself: its registers by name (GenICam's standard features naming convention 2.7),
// its pixel formats, and how their bits lie. See gige_camera.h.
#include <array>
#include <tuple>

#include "acquisition/desk/gige_camera.h"
#include "base/text.h"

namespace gonio::acquisition::desk {
namespace {

std::string register_node(const char* kind, const char* name, const char* address, int length, const char* access,
                          const char* port = "Device", const std::string& more = {}) {
  const bool whole = std::string_view(kind) == "IntReg";
  return format(
      "<%s Name=\"%s\"><Address>%s</Address>%s<Length>%d</Length><AccessMode>%s</AccessMode>"
      "<pPort>%s</pPort>%s<Endianess>BigEndian</Endianess></%s>\n",
      kind, name, address, more.c_str(), length, access, port, whole ? "<Sign>Unsigned</Sign>" : "", kind);
}

std::string enumeration(const char* name, const char* value, const std::vector<GigeFormat>& entries) {
  std::string text = format("<Enumeration Name=\"%s\" NameSpace=\"Standard\">", name);
  for (const GigeFormat& entry : entries)
    text += format("<EnumEntry Name=\"%s\" NameSpace=\"Standard\"><Value>%u</Value></EnumEntry>", entry.name.c_str(),
                   static_cast<unsigned>(entry.number));
  return text + format("<pValue>%s</pValue></Enumeration>\n", value);
}

std::string integer(const char* name, const char* value, const char* most) {
  return format("<Integer Name=\"%s\" NameSpace=\"Standard\"><pValue>%s</pValue><Min>1</Min><%s</Integer>\n", name,
                value, most);
}

std::string real(const char* name, const char* value, const char* unit, const char* least, const char* most) {
  return format(
      "<Float Name=\"%s\" NameSpace=\"Standard\"><pValue>%s</pValue><Min>%s</Min><Max>%s</Max>"
      "<Unit>%s</Unit></Float>\n",
      name, value, least, most, unit);
}

std::string command(const char* name, const char* target, int value) {
  return format(
      "<Command Name=\"%s\" NameSpace=\"Standard\"><pValue>%s</pValue><CommandValue>%d</CommandValue>"
      "</Command>\n",
      name, target, value);
}

std::string chunk(const char* name, const char* kind, const char* id) {
  const std::string port = std::string(name) + "Port";
  return register_node(kind, name, "0", 8, "RO", port.c_str()) +
         format("<Port Name=\"%s\"><ChunkID>%s</ChunkID></Port>\n", port.c_str(), id);
}

const char* const description_head =
    R"(<?xml version="1.0" encoding="utf-8"?>
<RegisterDescription ModelName="simulated" VendorName="gonio" StandardNameSpace="GEV" SchemaMajorVersion="1"
 SchemaMinorVersion="1" SchemaSubMinorVersion="0" MajorVersion="1" MinorVersion="0" SubMinorVersion="0" ToolTip=""
 ProductGuid="0" VersionGuid="0" xmlns="http://www.genicam.org/GenApi/Version_1_1">
<Category Name="Root" NameSpace="Standard"><pFeature>Features</pFeature></Category>
)";

std::string category() {
  std::string text = "<Category Name=\"Features\" NameSpace=\"Custom\">";
  for (const char* name : {"DeviceVendorName",
                           "DeviceModelName",
                           "DeviceSerialNumber",
                           "DeviceTemperature",
                           "Width",
                           "Height",
                           "PixelFormat",
                           "AcquisitionMode",
                           "AcquisitionStart",
                           "AcquisitionStop",
                           "TriggerSelector",
                           "TriggerMode",
                           "TriggerSource",
                           "TriggerActivation",
                           "TriggerSoftware",
                           "ExposureTime",
                           "Gain",
                           "ChunkModeActive",
                           "ChunkSelector",
                           "ChunkEnable",
                           "PayloadSize"})
    text += format("<pFeature>%s</pFeature>", name);
  return text + "</Category>\n";
}

std::string acquisition_part() {
  const char* per_trigger = "<pIndex Offset=\"0x20\">TriggerSelectorInteger</pIndex>";
  return enumeration("AcquisitionMode", "AcquisitionModeRegister", {{"Continuous", 1}, {"SingleFrame", 2}}) +
         register_node("IntReg", "AcquisitionModeRegister", "0x12c", 4, "RW") +
         command("AcquisitionStart", "AcquisitionRegister", 1) + command("AcquisitionStop", "AcquisitionRegister", 0) +
         register_node("IntReg", "AcquisitionRegister", "0x124", 4, "RW") +
         enumeration("TriggerSelector", "TriggerSelectorInteger", {{"FrameStart", 0}}) +
         "<Integer Name=\"TriggerSelectorInteger\" NameSpace=\"Custom\"><Value>0</Value></Integer>\n" +
         enumeration("TriggerMode", "TriggerModeRegister", {{"Off", 0}, {"On", 1}}) +
         register_node("IntReg", "TriggerModeRegister", "0x300", 4, "RW", "Device", per_trigger) +
         enumeration("TriggerSource", "TriggerSourceRegister", {{"Software", 1}}) +
         register_node("IntReg", "TriggerSourceRegister", "0x304", 4, "RW", "Device", per_trigger) +
         enumeration("TriggerActivation", "TriggerActivationRegister", {{"RisingEdge", 0}}) +
         register_node("IntReg", "TriggerActivationRegister", "0x308", 4, "RW", "Device", per_trigger) +
         command("TriggerSoftware", "TriggerSoftwareRegister", 1) +
         register_node("IntReg", "TriggerSoftwareRegister", "0x30c", 4, "RW", "Device", per_trigger) +
         real("ExposureTime", "ExposureTimeRegister", "us", "1", "3600000000") +
         register_node("FloatReg", "ExposureTimeRegister", "0x440", 8, "RW") +
         real("Gain", "GainRegister", "dB", "0", "48") + register_node("FloatReg", "GainRegister", "0x448", 8, "RW") +
         register_node("FloatReg", "DeviceTemperature", "0x450", 8, "RO");
}

std::string chunk_part() {
  return "<Boolean Name=\"ChunkModeActive\" NameSpace=\"Standard\"><pValue>ChunkModeRegister</pValue>"
         "<OnValue>1</OnValue><OffValue>0</OffValue></Boolean>\n" +
         register_node("IntReg", "ChunkModeRegister", "0x460", 4, "RW") +
         enumeration("ChunkSelector", "ChunkSelectorInteger", {{"ExposureTime", 0}, {"Gain", 1}, {"FrameID", 2}}) +
         "<Integer Name=\"ChunkSelectorInteger\" NameSpace=\"Custom\"><Value>0</Value></Integer>\n"
         "<Boolean Name=\"ChunkEnable\" NameSpace=\"Standard\"><pValue>ChunkEnableRegister</pValue>"
         "<OnValue>1</OnValue><OffValue>0</OffValue></Boolean>\n" +
         register_node("IntReg", "ChunkEnableRegister", "0x470", 4, "RW", "Device",
                       "<pIndex Offset=\"4\">ChunkSelectorInteger</pIndex>") +
         chunk("ChunkExposureTime", "FloatReg", "1001") + chunk("ChunkGain", "FloatReg", "1002") +
         chunk("ChunkFrameID", "IntReg", "1003");
}

}  // namespace

std::vector<GigeFormat> gige_formats(const std::string& mosaic) {
  struct Known {
    const char* mosaic;
    std::array<std::uint32_t, 6> numbers;  // of `depths`
  };
  static const std::array<Known, 5> all{
      {{"Mono", {0x01080001, 0x01100003, 0x01100005, 0x01100007, 0x010C0047, 0x010C0006}},
       {"BayerGR", {0x01080008, 0x0110000C, 0x01100010, 0x0110002E, 0x010C0057, 0x010C002A}},
       {"BayerRG", {0x01080009, 0x0110000D, 0x01100011, 0x0110002F, 0x010C0059, 0x010C002B}},
       {"BayerGB", {0x0108000A, 0x0110000E, 0x01100012, 0x01100030, 0x010C0055, 0x010C002C}},
       {"BayerBG", {0x0108000B, 0x0110000F, 0x01100013, 0x01100031, 0x010C0053, 0x010C002D}}}};
  static const std::array<const char*, 6> depths{"8", "10", "12", "16", "12p", "12Packed"};
  std::vector<GigeFormat> formats;
  for (const Known& known : all)
    for (std::size_t i = 0; known.mosaic == mosaic && i < depths.size(); ++i)
      formats.push_back({mosaic + depths[i], known.numbers[i]});
  return formats;
}

std::string pack(const std::vector<std::uint16_t>& samples, const PixelFormat& format) {
  std::string bytes;
  bytes.reserve(samples.size() * 2);
  if (format.packing == PixelFormat::Packing::pfnc) {
    std::uint32_t held = 0;
    int bits = 0;
    for (const std::uint16_t sample : samples) {
      held |= static_cast<std::uint32_t>(sample) << bits;
      for (bits += format.bits; bits >= 8; bits -= 8, held >>= 8) bytes.push_back(static_cast<char>(held));
    }
    if (bits > 0) bytes.push_back(static_cast<char>(held));
    return bytes;
  }
  if (format.packing == PixelFormat::Packing::gige) {
    const int low = format.bits - 8;
    for (std::size_t i = 0; i < samples.size(); i += 2) {
      const unsigned first = samples[i], second = i + 1 < samples.size() ? samples[i + 1] : 0U, mask = (1U << low) - 1;
      for (const unsigned byte : {first >> low, (first & mask) | (second & mask) << 4U, second >> low})
        bytes.push_back(static_cast<char>(byte));
    }
    return bytes;
  }
  for (const std::uint16_t sample : samples) {
    bytes.push_back(static_cast<char>(sample & 255U));
    if (format.bits > 8) bytes.push_back(static_cast<char>(sample >> 8U));
  }
  return bytes;
}

std::string gige_description(const std::vector<GigeFormat>& formats) {
  std::string text = description_head;
  text += category();
  for (const auto& [name, address, length] : {std::tuple{"DeviceVendorName", "0x48", 32},
                                              {"DeviceModelName", "0x68", 32},
                                              {"DeviceSerialNumber", "0xd8", 16}})
    text += register_node("StringReg", name, address, length, "RO");
  text += integer("Width", "WidthRegister", "pMax>SensorWidthRegister</pMax>") +
          integer("Height", "HeightRegister", "pMax>SensorHeightRegister</pMax>") +
          register_node("IntReg", "WidthRegister", "0x100", 4, "RO") +
          register_node("IntReg", "HeightRegister", "0x104", 4, "RO") +
          register_node("IntReg", "SensorHeightRegister", "0x118", 4, "RO") +
          register_node("IntReg", "SensorWidthRegister", "0x11c", 4, "RO") +
          enumeration("PixelFormat", "PixelFormatRegister", formats) +
          register_node("IntReg", "PixelFormatRegister", "0x128", 4, "RW") + acquisition_part() + chunk_part() +
          register_node("IntReg", "PayloadSize", "0x420", 4, "RO") +
          "<Integer Name=\"TLParamsLocked\"><Value>0</Value><Min>0</Min><Max>1</Max></Integer>\n"
          "<Port Name=\"Device\" NameSpace=\"Standard\"/>\n</RegisterDescription>\n";
  return text;
}

}  // namespace gonio::acquisition::desk
