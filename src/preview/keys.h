#pragma once
// The help for keys and buttons, for the panel and `binosplat view --help`. window_input.cpp implements them.

namespace binosplat::preview {

struct KeyHelp {
  const char* keys;
  const char* what;
};

inline constexpr KeyHelp key_help[] = {
    {"left button", "drag: orbit around the target"},
    {"right button", "drag: turn the head"},
    {"middle button", "drag: move the head"},
    {"wheel", "nearer, farther"},
    {"double click", "look at that point, and orbit around it"},
    {"M", "measure the scale: click two points, and type their distance in metres"},
    {"W A S D Q E", "move; faster with Shift"},
    {"G", "walk level with the ground, or fly"},
    {"N, P", "next camera, previous camera"},
    {"R", "back to the camera (reset view)"},
    {"Z", "show all: see the whole model from outside"},
    {"L, V", "next layout, debug view; Shift: previous"},
    {"B, C", "show or hide a grid on the ground, the cameras"},
    {"X", "switch between the chosen and the exact picture"},
    {"T, H", "next (exact) tile test, threshold; Shift: previous"},
    {"F", "full screen, or a window again"},
    {"F1", "show or hide the panel"},
    {"F5", "read the model again"},
    {"F8", "record ten seconds of frames, as `profile` does"},
    {"F9", "save the pose beside the model"},
    {"F11, F12", "save an OpenEXR of both eyes, a PNG"},
    {"Tab, arrows", "next number in the panel, next widget; Space presses it"},
    {"K, Space", "add a key to the path, play the path"},
    {"Escape", "leave full screen, or end"},
};

}  // namespace binosplat::preview
