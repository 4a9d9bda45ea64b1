// The module onnx (base/loaded_library.h): networks as ONNX files, by OpenCV's DNN, which brings protobuf along.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

extern "C" {
// Reads `bytes` of an ONNX file and takes `seen`, one picture of channels x height x width, through it. `answers` gets
// channels_out x height_out x width_out numbers. Non-empty `error` in the words of OpenCV: what it does not understand.
// The last network is kept: calls with the same bytes do not read them again.
void gonio_onnx_answers(const std::vector<char>& bytes, const std::vector<float>& seen, std::size_t channels,
                        std::size_t height, std::size_t width, std::vector<float>& answers, std::size_t& channels_out,
                        std::size_t& height_out, std::size_t& width_out, std::string& error);
void gonio_onnx_threads(int count);
}
