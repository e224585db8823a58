//! Options of render settings: one for each row of the table [`SETTINGS`].

use super::values;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, ArgAction, ArgMatches, Command, FromArgMatches};
use spherule_render::scene::Settings;
use spherule_render::settings::{Kind, Role, SETTINGS, Setting, Value};

/// Settings given on the command line: those of the display transform, or all others.
#[derive(Clone, Debug, Default)]
pub(in crate::cli) struct SettingArgs<const DISPLAY: bool> {
    /// Names of settings, and their values, in the order of the table.
    values: Vec<(&'static str, Value)>,
}

impl<const DISPLAY: bool> SettingArgs<DISPLAY> {
    /// Returns the settings of this group.
    fn table() -> impl Iterator<Item = &'static Setting> {
        SETTINGS.iter().filter(|setting| (setting.role == Role::Display) == DISPLAY)
    }

    /// Returns the settings that are given.
    pub(in crate::cli) fn given(&self) -> impl Iterator<Item = &'static Setting> {
        self.values.iter().filter_map(|(name, _)| Setting::named(name))
    }

    /// Returns the value of a setting, if it is given.
    pub(in crate::cli) fn value(&self, name: &str) -> Option<Value> {
        self.values.iter().find(|row| row.0 == name).map(|row| row.1)
    }

    /// Returns names and values of those that are given.
    pub(in crate::cli) fn values(&self) -> &[(&'static str, Value)] {
        &self.values
    }

    /// Overrides settings with those that are given.
    pub(in crate::cli) fn apply(&self, settings: &mut Settings) {
        settings.change(&self.values);
    }
}

impl SettingArgs<false> {
    /// Returns the number of samples per pixel, if it is given.
    pub(in crate::cli) fn spp(&self) -> Option<u32> {
        self.whole("spp").map(|spp| spp as u32)
    }

    /// Returns the seed, if it is given.
    pub(in crate::cli) fn seed(&self) -> Option<u64> {
        self.whole("seed")
    }

    fn whole(&self, name: &str) -> Option<u64> {
        match self.value(name) {
            Some(Value::Whole(number)) => Some(number),
            _ => None,
        }
    }
}

impl<const DISPLAY: bool> clap::Args for SettingArgs<DISPLAY> {
    fn augment_args(command: Command) -> Command {
        command.args(Self::table().map(option))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<const DISPLAY: bool> FromArgMatches for SettingArgs<DISPLAY> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let value = |setting: &'static Setting| match setting.kind {
            Kind::Flag => matches.get_flag(setting.name).then_some(Value::Flag(false)),
            _ => matches.get_one::<Value>(setting.name).copied(),
        };
        let values = Self::table().filter_map(|setting| Some((setting.name, value(setting)?)));
        Ok(Self { values: values.collect() })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Returns the name of a setting's option.
pub(in crate::cli) fn option_name(setting: &Setting) -> String {
    let name = setting.name.replace('_', "-");
    if let Kind::Flag = setting.kind { format!("no-{name}") } else { name }
}

/// Returns the option of a setting.
fn option(setting: &'static Setting) -> Arg {
    let Setting { name, help, kind, .. } = setting;
    let option = Arg::new(*name).long(option_name(setting)).help(*help);
    let placeholder = match kind {
        Kind::Flag => {
            let (first, rest) = help.split_at(1);
            let help = format!("Do not {}{rest}", first.to_lowercase());
            return option.help(help).action(ArgAction::SetTrue);
        }
        Kind::Choice(list) => {
            let names = list().into_iter().map(|(name, help)| PossibleValue::new(name).help(help));
            let word = |name: &str| list().into_iter().map(|row| row.0).find(|row| *row == name);
            let parser = PossibleValuesParser::new(names)
                .try_map(move |name| word(&name).map(Value::Word).ok_or("not one of the names"));
            return option.value_name(name.to_uppercase()).value_parser(parser);
        }
        Kind::Size => "WxH|LENGTH",
        Kind::Whole { .. } => "N",
        Kind::Number { placeholder, .. } => *placeholder,
        Kind::Error => "PERCENT",
        Kind::Time => "TIME",
    };
    let option = match kind {
        Kind::Error => option.help(format!("{help}; none for no limit")),
        Kind::Time => option.help(format!("{help}, as in 60s or 5m; none for no limit")),
        Kind::Number { words: ["inf"], .. } => option.help(format!("{help}; inf for no limit")),
        _ => option,
    };
    option
        .value_name(placeholder)
        .allow_hyphen_values(true)
        .value_parser(move |text: &str| values::setting(kind, text))
}
