// Libraries that are loaded when the first function of theirs is called. The loader looks every name of every library
// that a program is linked with up in all of them before main() begins: PCL with VTK behind it, FCL, OMPL, GDCM,
// OpenCV's networks and HDF5 are 85 of the 100 ms that each start of each program took, and most runs call none of
// them.
//
// What is called by few plain functions is found in the library itself, by its name. What needs the library's types
// (templates, classes to derive from) is a module: a source lib/ROOM/**/NAME_module.cpp becomes a shared library of its
// own (cmake/rooms.cmake, gonio_module), and the header of that name declares its functions, extern "C". A module is
// linked with nothing of ours: it may use what headers of ours define in line, and what it is given to call.
#pragma once
#include <string>

namespace gonio {

// The function NAME of LIBRARY, a file as the loader finds it ("libmatio.so.11"). Error(internal) where either is not
// there, with `remedy`.
void* function_in(const char* library, const char* name, const std::string& remedy);

// The same of a module: lib/gonio/gonio_NAME.so in the folder of the program or one of the three above it.
void* function_in_module(const char* module, const char* name);

template <class Function>
void load(Function*& function, const char* library, const char* name, const std::string& remedy) {
  function = reinterpret_cast<Function*>(function_in(library, name, remedy));
}
template <class Function>
Function* loaded_from_module(const char* module, const char* name) {
  return reinterpret_cast<Function*>(function_in_module(module, name));
}

}  // namespace gonio
