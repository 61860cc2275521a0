#pragma once
// The help for keys and buttons, for the panel and `binosplat view --help`. window_input.cpp implements them.

namespace binosplat::preview {

struct KeyHelp {
  const char* keys;
  const char* what;
};

inline constexpr KeyHelp key_help[] = {
    {"left button", "drag: go around what is looked at"},
    {"right button", "drag: turn the head"},
    {"middle button", "drag: move the head"},
    {"wheel", "nearer, farther"},
    {"double click", "look at what lies there"},
    {"W A S D Q E", "go; faster with Shift"},
    {"G", "walk level with the ground, or fly"},
    {"N, P", "next camera, the one before"},
    {"R", "back to the camera (reset view)"},
    {"L, V", "next layout, kind of picture; Shift: back"},
    {"B, C", "show or hide a grid on the ground, the cameras"},
    {"X", "flip between the picture and the exact one"},
    {"T, H", "next (exact) tile test, threshold; Shift: back"},
    {"F", "full screen, or a window again"},
    {"F1", "show or hide the panel"},
    {"F5", "read the model again"},
    {"F8", "record ten seconds of frames, as `profile` does"},
    {"F9", "save the pose beside the model"},
    {"F11, F12", "save an OpenEXR of both eyes, a PNG"},
    {"Tab, arrows", "to the next number in the panel, go about in it; Space presses"},
    {"K, Space", "add a key to the path, play the path (of a moving scene: hold it, let it go on)"},
    {"Escape", "leave full screen, or end"},
};

}  // namespace binosplat::preview
