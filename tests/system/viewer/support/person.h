// Person: reads the pixels of evoview's window, presses keys and moves the mouse, by Xlib.
#pragma once

#include "tests/support/waiting.h"
#include "tests/system/viewer/support/pixels.h"

#include <SFML/Graphics/Image.hpp>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/keysym.h>
// Macros of Xlib that other headers use as names.
#undef Bool
#undef ClientMessage
#undef None
#undef Status
#undef Success

#include <string>

namespace evod::viewer {

class Person {
  public:
    Person() : display_{XOpenDisplay(nullptr)} {
        // Reading a window fails while it is moved or redrawn; then looks_until() tries again.
        XSetErrorHandler([](Display*, XErrorEvent*) { return 0; });
    }
    ~Person() { XCloseDisplay(display_); }

    bool finds_window() {
        return looks_until([this] {
            ::Window root, parent, *children = nullptr;
            unsigned count = 0;
            XQueryTree(display_, DefaultRootWindow(display_), &root, &parent, &children, &count);
            for (unsigned i = 0; i < count; ++i) {
                char* name = nullptr;
                if (XFetchName(display_, children[i], &name) != 0 && name != nullptr) {
                    window_ = std::string{name} == "evoview" ? children[i] : window_;
                    XFree(name);
                }
            }
            if (children != nullptr) {
                XFree(children);
            }
            // The window has its name before it is mapped; only a mapped window can be read.
            XWindowAttributes attributes{};
            return window_ != 0 && XGetWindowAttributes(display_, window_, &attributes) != 0 &&
                   attributes.map_state == IsViewable;
        });
    }

    struct Place {
        int x, y, width, height; // on the screen
        friend bool operator==(const Place&, const Place&) = default;
    };
    Place finds_place() {
        XWindowAttributes size{};
        int x = 0, y = 0;
        ::Window child;
        XGetWindowAttributes(display_, window_, &size);
        XTranslateCoordinates(display_, window_, DefaultRootWindow(display_), 0, 0, &x, &y, &child);
        return {x, y, size.width, size.height};
    }
    Place whole_screen() {
        const int screen = DefaultScreen(display_);
        return {0, 0, DisplayWidth(display_, screen), DisplayHeight(display_, screen)};
    }

    bool sees(Colour colour) {
        return looks_until([&] { return count(looks(), colour) > 50; });
    }

    /// Checks the condition until it holds, with pauses for drawing; false if it does not hold in time.
    template <class Condition>
    static bool looks_until(Condition condition) {
        return wait_until(condition, [] { std::this_thread::sleep_for(std::chrono::milliseconds{20}); });
    }

    /// The pixels of the window; an empty image if they cannot be read now.
    sf::Image looks() {
        sf::Image seen;
        XWindowAttributes size{};
        if (XGetWindowAttributes(display_, window_, &size) == 0) {
            return seen;
        }
        XImage* image = XGetImage(display_, window_, 0, 0, static_cast<unsigned>(size.width),
                                  static_cast<unsigned>(size.height), AllPlanes, ZPixmap);
        if (image == nullptr) {
            return seen;
        }
        seen.create(static_cast<unsigned>(size.width), static_cast<unsigned>(size.height));
        for (unsigned y = 0; y < seen.getSize().y; ++y) {
            for (unsigned x = 0; x < seen.getSize().x; ++x) {
                const unsigned long pixel = XGetPixel(image, static_cast<int>(x), static_cast<int>(y));
                seen.setPixel(x, y, sf::Color{static_cast<sf::Uint32>(pixel << 8 | 0xff)});
            }
        }
        XDestroyImage(image);
        return seen;
    }

    void move_mouse(int x, int y) { send_mouse(MotionNotify, x, y); }
    void press_mouse(int x, int y) { send_mouse(ButtonPress, x, y); }
    void release_mouse(int x, int y) { send_mouse(ButtonRelease, x, y); }

    void press(KeySym key, bool shift = false) {
        XEvent event{};
        event.xkey.display = display_;
        event.xkey.window = window_;
        event.xkey.root = DefaultRootWindow(display_);
        event.xkey.same_screen = True;
        event.xkey.keycode = XKeysymToKeycode(display_, key);
        event.xkey.state = shift ? ShiftMask : 0;
        for (const int type : {KeyPress, KeyRelease}) {
            event.xkey.type = type;
            event.xkey.time = time_ += 20;
            XSendEvent(display_, window_, True, type == KeyPress ? KeyPressMask : KeyReleaseMask, &event);
        }
        XFlush(display_);
    }

  private:
    /// Sends a press or release of the left button, or a movement.
    void send_mouse(int type, int x, int y) {
        XEvent event{};
        event.xbutton.type = type; // XMotionEvent has the same layout, without the button
        event.xbutton.display = display_;
        event.xbutton.window = window_;
        event.xbutton.root = DefaultRootWindow(display_);
        event.xbutton.same_screen = True;
        event.xbutton.x = x;
        event.xbutton.y = y;
        event.xbutton.time = time_ += 20;
        if (type != MotionNotify) {
            event.xbutton.button = Button1;
        }
        XSendEvent(display_, window_, True,
                   type == MotionNotify  ? PointerMotionMask
                   : type == ButtonPress ? ButtonPressMask
                                         : ButtonReleaseMask,
                   &event);
        XFlush(display_);
    }

    Display* display_;
    ::Window window_ = 0;
    Time time_ = 1000;
};

} // namespace evod::viewer
