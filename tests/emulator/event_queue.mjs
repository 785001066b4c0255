// SPDX-License-Identifier: Apache-2.0
/** What is to happen at which cycle; equal times in the order in which they were asked for. */
export class EventQueue {
    constructor() {
        this.events = []; // latest first, so that the next one is popped off the end
        this.next = Infinity;
    }

    /** Call `action` at cycle `time`. @returns a handle for cancel(). */
    at(time, action) {
        const event = { time, action };
        const { events } = this;
        let index = events.length;
        while (index > 0 && events[index - 1].time <= time) {
            index--;
        }
        events.splice(index, 0, event);
        this.next = events[events.length - 1].time;
        return event;
    }

    cancel(event) {
        const index = event ? this.events.indexOf(event) : -1;
        if (index >= 0) {
            this.events.splice(index, 1);
            this.#update();
        }
    }

    /** Carry out all that is due at `time` or before, what is added meanwhile included. */
    run(time) {
        while (this.next <= time) {
            const event = this.events.pop();
            this.#update();
            event.action();
        }
    }

    #update() {
        const { events } = this;
        this.next = events.length ? events[events.length - 1].time : Infinity;
    }
}
