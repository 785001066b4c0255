// SPDX-License-Identifier: Apache-2.0
/** One RP2040 from a reset to the next: rp2040js' processor core, clocks and pins, with cycle-true
 * blocks of our own for all that the trigger box lives by. */
import { RP2040 } from 'rp2040js';
import { bootRomImage, callRom } from './boot_rom.mjs';
import { DmaBlock } from './dma_block.mjs';
import { EventQueue } from './event_queue.mjs';
import { FLASH_SIZE } from './flash_chip.mjs';
import { GpioNets } from './gpio_nets.mjs';
import { PioBlock } from './pio_block.mjs';
import { RESET_BITS, ResetGuard, ResetsBlock } from './resets_block.mjs';
import * as small from './small_blocks.mjs';
import { SsiBlock } from './ssi_block.mjs';
import { TimerBlock } from './timer_block.mjs';
import { UsbDeviceBlock } from './usb_device_block.mjs';
import { WatchdogBlock } from './watchdog_block.mjs';

export const CLOCK_HZ = 125000000;
const NS_PER_CYCLE = 8, RAM = 0x20000000, BOOT2_COPY = 0x20041f00, FLASH = 0x10000000;
const VECTOR_BOOT_MAGIC = 0xb007c0d3;

export class Chip {
    /** @param settings  {flash, now, random, outside, onLevel, onReset, resetCause, watchdog, ram}:
     *  the board's flash, the cycle at which it starts, its source of noise, levels driven from
     *  outside, who hears of levels and of a reset that the chip asks for, why it starts. */
    constructor(settings) {
        this.flash = settings.flash;
        this.now = settings.now;
        this.startedAt = settings.now;
        this.onReset = settings.onReset;
        this.events = new EventQueue();
        this.faults = [];
        this.busyUntil = 0;    // the CPU does nothing until then
        this.flashBusyUntil = 0;
        this.instructions = 0;
        this.bootloader = null; // arguments of the call into the USB bootloader
        this.dead = false;
        this.ssi = new SsiBlock(this, this.flash);
        this.#makeCore(settings);
        this.#makeBlocks(settings);
        this.nets = new GpioNets(this, settings.outside, settings.onLevel);
        this.nets.refreshAll();
        this.#boot();
    }

    // --- construction ---------------------------------------------------------------------------

    #makeCore({ random, ram }) {
        const mcu = new RP2040();
        this.mcu = mcu;
        mcu.logger = this.#logger();
        mcu.clock.nanosCounter = this.now * NS_PER_CYCLE;
        mcu.flash = this.flash.bytes;
        mcu.flash16 = new Uint16Array(mcu.flash.buffer);
        mcu.flashView = this.flash.view;
        mcu.bootrom.set(bootRomImage());
        mcu.onBreak = (index) => callRom(this, index);
        this.#fillRam(ram, random);
        this.#replaceMemoryAccess(mcu);
        this.#replaceInterruptEntry(mcu.core);
    }

    #logger() {
        const quiet = () => undefined;
        return {
            debug: quiet, info: quiet,
            warn: (name, text) => this.fault(`${name}: ${text}`),
            error: (name, text) => this.fault(`${name}: ${text}`),
        };
    }

    /** Memory holds noise after power-up, and what it held after any other reset. */
    #fillRam(ram, random) {
        const { sram } = this.mcu;
        if (ram) {
            sram.set(ram);
            return;
        }
        const words = new Uint32Array(sram.buffer);
        for (let index = 0; index < words.length; index++) {
            words[index] = random();
        }
    }

    /** Faster than rp2040js' own, and with what silicon does: no reads from a flash that is not
     * in XIP mode, no writes to ROM or flash. */
    #replaceMemoryAccess(mcu) {
        const { sram, flash } = mcu, size = sram.length, top = FLASH_SIZE - 1;
        const ram16 = new Uint16Array(sram.buffer), ram32 = new Uint32Array(sram.buffer);
        const flash16 = new Uint16Array(flash.buffer), flash32 = new Uint32Array(flash.buffer);
        const original = {};
        for (const name of ['readUint32', 'readUint16', 'readUint8', 'writeUint32']) {
            original[name] = mcu[name].bind(mcu);
        }
        const { ssi } = this;
        const isFlash = (address) => address >= FLASH && address < 0x14000000 &&
            (ssi.xip || this.#faultAtFlash(address));
        mcu.readUint16 = (address) => {
            const inRam = address - RAM;
            if (isFlash(address)) {
                return flash16[(address & top) >>> 1];
            }
            return inRam >= 0 && inRam < size ? ram16[inRam >>> 1] : original.readUint16(address);
        };
        mcu.readUint32 = (signed) => {
            const address = signed >>> 0, inRam = address - RAM;
            if (address & 3) {
                this.fault(`word read at 0x${address.toString(16)}, which is not aligned`);
            }
            if (inRam >= 0 && inRam < size) {
                return ram32[inRam >>> 2];
            }
            return isFlash(address) ? flash32[(address & top) >>> 2]
                : original.readUint32(address);
        };
        mcu.readUint8 = (signed) => {
            const address = signed >>> 0, inRam = address - RAM;
            if (inRam >= 0 && inRam < size) {
                return sram[inRam];
            }
            return isFlash(address) ? flash[address & top] : original.readUint8(address);
        };
        mcu.writeUint32 = (signed, value) => {
            const address = signed >>> 0, inRam = address - RAM;
            if (inRam >= 0 && inRam < size && !(address & 3)) {
                ram32[inRam >>> 2] = value;
            } else if (address >= FLASH && address < 0x14000000) {
                this.fault(`write to flash at 0x${address.toString(16)}`);
            } else if (address >= 0x4000) { // writes to ROM have no effect
                original.writeUint32(address, value);
            }
        };
        for (const name of ['readUint32', 'readUint16', 'readUint8', 'writeUint32']) {
            mcu.core[name] = mcu[name];
        }
    }

    #faultAtFlash(address) {
        this.fault(`flash is read at 0x${address.toString(16)} outside of XIP`);
        return true;
    }

    /** rp2040js enters a handler from WFI even where PRIMASK forbids it; here an interrupt only
     * becomes pending, and the core takes it before its next instruction if it may. */
    #replaceInterruptEntry(core) {
        core.setInterrupt = (irq, on) => {
            const bit = 1 << irq;
            if (on && !(core.pendingInterrupts & bit)) {
                core.pendingInterrupts |= bit;
                core.interruptsUpdated = true;
            } else if (!on) {
                core.pendingInterrupts &= ~bit;
            }
        };
    }

    #makeBlocks({ random, resetCause, watchdog }) {
        const { mcu } = this;
        this.resets = new ResetsBlock(this);
        this.psm = new small.PsmBlock(this);
        this.dma = mcu.dma = new DmaBlock(this);
        this.timer = new TimerBlock(this);
        this.watchdog = new WatchdogBlock(this, watchdog);
        this.pio = mcu.pio = [new PioBlock(this, 0, 7, 0), new PioBlock(this, 1, 9, 8)];
        this.usb = mcu.usbCtrl = new UsbDeviceBlock(this);
        Object.assign(mcu.peripherals, {
            0x14000: new small.XipControlBlock(this), 0x18000: this.ssi,
            0x40000: new small.SysInfoBlock(this, 'SYSINFO'), 0x4000c: this.resets,
            0x40010: this.psm, 0x40018: new small.IoQspiBlock(this), 0x40054: this.timer,
            0x40058: this.watchdog, 0x40060: new small.RoscBlock(this, random),
            0x40064: new small.ChipResetBlock(this, resetCause), 0x50000: this.dma,
            0x50110: this.usb, 0x50200: this.pio[0], 0x50300: this.pio[1],
        });
        const own = { DMA: this.dma, TIMER: this.timer, USBCTRL: this.usb, PIO0: this.pio[0],
            PIO1: this.pio[1] };
        for (const [name, [bit, place]] of Object.entries(RESET_BITS)) {
            const guard = new ResetGuard(this, name, bit, mcu.peripherals[place]);
            mcu.peripherals[place] = guard;
            if (own[name]) {
                this.resets.blocks.set(bit, own[name]);
            }
            guard.onWrite = this.#writeHook(name);
        }
    }

    #writeHook(name) {
        switch (name) {
            case 'IO_BANK0': // input overrides change what PIO sees
                return (offset) => offset < 0xf0 && this.nets.refresh(offset >>> 3);
            case 'PADS_BANK0':
                return (offset) => {
                    const pin = (offset >>> 2) - 1;
                    if (pin >= 0 && pin < 30) {
                        if (!this.nets.padWrites.has(pin)) {
                            this.nets.padWrites.set(pin, this.now);
                        }
                        this.nets.refresh(pin);
                    }
                };
            default: return null;
        }
    }

    /** What the ROM does at reset: copy the second stage to RAM if its CRC is right, and enter. */
    #boot() {
        const { core, sram } = this.mcu, boot2 = this.flash.bytes.subarray(0, 256);
        if (this.watchdog.scratch[4] === VECTOR_BOOT_MAGIC) {
            throw new Error('a boot to a vector in the watchdog\'s scratch is not modelled');
        }
        if (crc32Of(boot2.subarray(0, 252)) !== this.flash.view.getUint32(252, true)) {
            this.enterBootloader(0, 0);
            return;
        }
        sram.set(boot2, BOOT2_COPY - RAM);
        core.VTOR = 0;
        core.SP = BOOT2_COPY;
        core.LR = 0; // boot2 then goes on by the vector table behind it
        core.PC = BOOT2_COPY;
    }

    // --- what blocks tell -----------------------------------------------------------------------

    /** Something that would not work on silicon, or that is not modelled. */
    fault(text) {
        const where = this.mcu ? ` (pc 0x${(this.mcu.core.PC >>> 0).toString(16)})` : '';
        if (this.faults.length < 100) {
            this.faults.push(text + where);
        }
    }

    onPioEnabled() {}

    requestReset(watchdog) {
        this.dead = true; // ends the current run() at once
        this.onReset(watchdog);
    }

    enterBootloader(pins, disabled) {
        this.bootloader = { pins, disabled };
        this.usb.write(0x4c, 0, 0); // the ROM begins anew on the bus
        this.busyUntil = Infinity;
    }

    /** The CPU works in ROM for so many cycles. */
    spend(cycles) {
        this.busyUntil = Math.max(this.busyUntil, this.now + cycles);
    }

    keepFlashBusy(cycles) {
        this.spend(cycles);
        this.flashBusyUntil = this.busyUntil;
    }

    /** Keep the CPU from executing anything, as a debugger or a fault would; PIO, DMA, timers,
     * watchdog and USB hardware go on. */
    holdCpu(cycles) {
        this.spend(cycles);
    }

    // --- time -----------------------------------------------------------------------------------

    #nextDue() {
        const alarm = this.mcu.clock.nextAlarm;
        return Math.min(this.events.next, this.pio[0].due, this.pio[1].due,
            alarm ? Math.ceil(alarm.nanos / NS_PER_CYCLE) : Infinity);
    }

    #setNow(time) {
        const { clock } = this.mcu, nanos = time * NS_PER_CYCLE;
        this.now = time;
        if (clock.nextAlarm && clock.nextAlarm.nanos <= nanos) {
            clock.tick(nanos - clock.nanosCounter);
        } else {
            clock.nanosCounter = nanos;
        }
    }

    /** Let everything but the CPU get to cycle `target`, that cycle included. */
    #advance(target) {
        for (let due = this.#nextDue(); due <= target && !this.dead; due = this.#nextDue()) {
            this.#setNow(Math.max(due, this.now));
            this.events.run(this.now);
            for (const block of this.pio) {
                if (block.due <= this.now) {
                    block.step(this.now);
                }
            }
        }
        if (!this.dead) {
            this.#setNow(target);
        }
    }

    /** Run to cycle `until`, or until the chip is reset. */
    run(until) {
        const { core } = this.mcu;
        while (this.now < until && !this.dead) {
            if (this.busyUntil > this.now) {
                this.#advance(Math.min(until, this.busyUntil, this.#nextDue()));
                this.#checkFlashBusy(core);
            } else if (core.waiting) {
                this.#sleep(core, until);
            } else {
                this.#execute(core, until);
            }
        }
    }

    /** Instructions one after the other, until something else is due: the inner loop of it all. */
    #execute(core, until) {
        const { events, mcu: { clock } } = this, [pio0, pio1] = this.pio;
        while (this.now < until && !core.waiting && this.busyUntil <= this.now && !this.dead) {
            const next = this.now + core.executeInstruction();
            this.instructions++;
            if (events.next <= next || pio0.due <= next || pio1.due <= next || clock.nextAlarm) {
                this.#advance(next);
            } else {
                this.now = next;
                clock.nanosCounter = next * NS_PER_CYCLE;
            }
        }
    }

    #sleep(core, until) {
        const wakes = (core.pendingInterrupts & core.enabledInterrupts) ||
            core.pendingSystick || core.pendingPendSV;
        if (wakes) {
            core.waiting = false;
            core.interruptsUpdated = true;
        } else {
            this.#advance(Math.max(this.now, Math.min(until, this.#nextDue())));
        }
    }

    #checkFlashBusy(core) {
        const takes = core.pendingInterrupts & core.enabledInterrupts && !core.PM;
        if (takes && this.now < this.flashBusyUntil) {
            this.fault('an interrupt would be taken while the flash is being written');
            this.flashBusyUntil = 0; // once is enough
        }
    }
}

/** CRC-32 as the boot ROM counts it: polynomial 0x04c11db7, from all ones, not reflected. */
function crc32Of(bytes) {
    let crc = 0xffffffff;
    for (const byte of bytes) {
        crc ^= byte << 24;
        for (let bit = 0; bit < 8; bit++) {
            crc = crc & 0x80000000 ? (crc << 1) ^ 0x04c11db7 : crc << 1;
        }
    }
    return crc >>> 0;
}
